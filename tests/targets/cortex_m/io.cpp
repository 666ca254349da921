#include "tests/targets/cortex_m/semihosting.h"
#include "tests/targets/target_io.h"

extern "C" {
extern char __text_start[], __text_end[], __data_start[], __data_end[], __bss_start[], __bss_end[];
extern std::uint32_t __stack_bottom[], __stack_top[];
}

namespace wirepose::testing {
namespace {

int g_pack = -1;

void Row(const char* name, const void* from, const void* to, std::size_t used) {
  Print("memory ");
  Print(name);
  Print(" 0x");
  PrintHex(reinterpret_cast<std::uintptr_t>(from), 8);
  Print(" size ");
  PrintNumber(static_cast<const char*>(to) - static_cast<const char*>(from));
  Print(" used ");
  PrintNumber(static_cast<std::int64_t>(used));
  Print("\n");
}

std::size_t Size(const void* from, const void* to) {
  return static_cast<std::size_t>(static_cast<const char*>(to) - static_cast<const char*>(from));
}

}  // namespace

bool OpenPack() {
  g_pack = semihosting::OpenForReading(kPackFile);
  return g_pack >= 0;
}

bool ReadPack(void* to, std::size_t size) { return semihosting::Read(g_pack, to, size) == size; }

void Print(const char* text) { semihosting::Write(text); }

void PrintMemoryMap() {
  const std::uint32_t* deepest = __stack_bottom;
  while (deepest < __stack_top && *deepest == semihosting::kStackPaint) ++deepest;
  Row("code", __text_start, __text_end, Size(__text_start, __text_end));
  Row("data", __data_start, __data_end, Size(__data_start, __data_end));
  Row("bss", __bss_start, __bss_end, Size(__bss_start, __bss_end));
  Row("stack", __stack_bottom, __stack_top, Size(deepest, __stack_top));
}

}  // namespace wirepose::testing
