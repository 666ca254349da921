#include "tests/targets/cortex_m/semihosting.h"

#include <cstring>

namespace wirepose::testing::semihosting {
namespace {

// Operations and open modes of Arm's "Semihosting for AArch32 and AArch64".
enum Operation : std::uint32_t { kOpen = 0x01, kWrite = 0x05, kRead = 0x06, kExitExtended = 0x20 };
enum Mode : std::uint32_t { kReadBinary = 1, kWriteText = 4 };
constexpr std::uint32_t kApplicationExit = 0x20026;

std::int32_t Call(Operation operation, const void* arguments) {
  register std::uint32_t r0 __asm("r0") = operation;
  register const void* r1 __asm("r1") = arguments;
  __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return static_cast<std::int32_t>(r0);
}

std::uint32_t Word(const void* pointer) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pointer));
}

int Open(const char* name, Mode mode) {
  const std::uint32_t arguments[] = {Word(name), mode, static_cast<std::uint32_t>(std::strlen(name))};
  return Call(kOpen, arguments);
}

}  // namespace

int OpenForReading(const char* name) { return Open(name, kReadBinary); }

std::size_t Read(int handle, void* to, std::size_t size) {
  const std::uint32_t arguments[] = {static_cast<std::uint32_t>(handle), Word(to), static_cast<std::uint32_t>(size)};
  const std::int32_t missing = Call(kRead, arguments);
  return size - static_cast<std::size_t>(missing);
}

void Write(const char* text) {
  static const int console = Open(":tt", kWriteText);
  const std::uint32_t arguments[] = {static_cast<std::uint32_t>(console), Word(text),
                                     static_cast<std::uint32_t>(std::strlen(text))};
  (void)Call(kWrite, arguments);
}

void Exit(int status) {
  const std::uint32_t arguments[] = {kApplicationExit, static_cast<std::uint32_t>(status)};
  (void)Call(kExitExtended, arguments);
  for (;;) {
  }
}

}  // namespace wirepose::testing::semihosting
