#include <array>

#include "tests/targets/target_io.h"

namespace wirepose::testing {
namespace {

void PrintDigits(std::uint64_t number, std::uint64_t base, int least) {
  std::array<char, 21> text{};  // 2^64 has 20 decimal digits
  std::size_t at = text.size() - 1;
  for (int digit = 0; number != 0 || digit < least; ++digit) {
    text[--at] = "0123456789abcdef"[number % base];
    number /= base;
  }
  Print(text.data() + at);
}

}  // namespace

void PrintNumber(std::int64_t number) {
  if (number < 0) Print("-");
  const auto bits = static_cast<std::uint64_t>(number);
  PrintDigits(number < 0 ? ~bits + 1 : bits, 10, 1);
}

void PrintHex(std::uint64_t number, int digits) { PrintDigits(number, 16, digits); }

}  // namespace wirepose::testing
