// Arm semihosting: the debugger or emulator lends the image its files and console.
#ifndef WIREPOSE_TESTS_TARGETS_CORTEX_M_SEMIHOSTING_H_
#define WIREPOSE_TESTS_TARGETS_CORTEX_M_SEMIHOSTING_H_

#include <cstddef>
#include <cstdint>

namespace wirepose::testing::semihosting {

// What unused stack holds.
inline constexpr std::uint32_t kStackPaint = 0xA5A5A5A5U;

// Handle of a file opened for reading, or -1.
[[nodiscard]] int OpenForReading(const char* name);
// Bytes read, fewer than `size` only at the end of the file.
[[nodiscard]] std::size_t Read(int handle, void* to, std::size_t size);
// Zero-terminated text to standard output.
void Write(const char* text);
[[noreturn]] void Exit(int status);

}  // namespace wirepose::testing::semihosting

#endif  // WIREPOSE_TESTS_TARGETS_CORTEX_M_SEMIHOSTING_H_
