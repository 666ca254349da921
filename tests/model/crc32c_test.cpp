#include "model/crc32c.h"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace wirepose {
namespace {

std::uint32_t Bitwise(std::span<const std::byte> bytes) {  // the definition, one bit at a time
  std::uint32_t c = ~0U;
  for (const std::byte b : bytes) {
    c ^= static_cast<std::uint32_t>(b);
    for (int i = 0; i < 8; ++i) c = (c & 1U) != 0 ? (c >> 1) ^ 0x82F63B78U : c >> 1;
  }
  return ~c;
}

TEST(Crc32c, AgreesWithThePublishedVectors) {  // RFC 3720, B.4, and the usual check value
  const std::string_view digits = "123456789";
  EXPECT_EQ(Crc32c(std::as_bytes(std::span(digits))), 0xE3069283U);
  std::vector<std::byte> bytes(32);
  EXPECT_EQ(Crc32c(bytes), 0x8A9136AAU);
  std::fill(bytes.begin(), bytes.end(), std::byte{0xFF});
  EXPECT_EQ(Crc32c(bytes), 0x62A8AB43U);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i);
  EXPECT_EQ(Crc32c(bytes), 0x46DD794EU);
  EXPECT_EQ(Crc32c({}), 0U);
}

TEST(Crc32c, AgreesWithTheBitwiseDefinition) {
  std::uint32_t state = 1;
  for (std::size_t length = 0; length < 300; ++length) {
    std::vector<std::byte> bytes(length);
    for (std::byte& b : bytes) {
      state = state * 1664525U + 1013904223U;
      b = static_cast<std::byte>(state >> 24);
    }
    ASSERT_EQ(Crc32c(bytes), Bitwise(bytes)) << length;
  }
}

}  // namespace
}  // namespace wirepose
