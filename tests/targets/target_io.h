// The little that a test program needs of its surroundings, on Linux and on bare metal alike. No heap.
#ifndef WIREPOSE_TESTS_TARGETS_TARGET_IO_H_
#define WIREPOSE_TESTS_TARGETS_TARGET_IO_H_

#include <cstddef>
#include <cstdint>

namespace wirepose::testing {

// The input file; its name is fixed because bare metal has no arguments.
inline constexpr const char* kPackFile = "frames.pack";

// The program: what main or the reset handler runs. Returns the exit status.
int RunTarget();

// Opens kPackFile in the current folder for reading. False when it cannot be opened.
[[nodiscard]] bool OpenPack();
// Reads exactly `size` bytes from where the last call ended. False when there are fewer.
[[nodiscard]] bool ReadPack(void* to, std::size_t size);
// Writes text to standard output.
void Print(const char* text);
// Decimal and hexadecimal (`digits` places).
void PrintNumber(std::int64_t number);
void PrintHex(std::uint64_t number, int digits);
// Memory that the linker and the deepest call so far took, one line each: nothing where an operating system hides it.
void PrintMemoryMap();

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_TARGETS_TARGET_IO_H_
