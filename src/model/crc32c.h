// CRC-32C (Castagnoli, reflected 0x1EDC6F41), as in RFC 3720 appendix B.4: guards model files
// against damage.
#ifndef WIREPOSE_MODEL_CRC32C_H_
#define WIREPOSE_MODEL_CRC32C_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace wirepose {

namespace crc32c_internal {

// Sixteen words, one a nibble: 64 bytes of flash instead of a kilobyte.
inline constexpr std::array<std::uint32_t, 16> kNibbleTable = [] {
  std::array<std::uint32_t, 16> table{};
  for (std::uint32_t i = 0; i < 16; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 4; ++bit) c = (c & 1U) != 0 ? (c >> 1) ^ 0x82F63B78U : c >> 1;
    table[i] = c;
  }
  return table;
}();

}  // namespace crc32c_internal

// The checksum of `bytes`; of nothing: 0. O(n), about ten operations a byte.
constexpr std::uint32_t Crc32c(std::span<const std::byte> bytes) {
  std::uint32_t c = 0xFFFFFFFFU;
  for (const std::byte b : bytes) {
    c ^= static_cast<std::uint32_t>(b);
    c = crc32c_internal::kNibbleTable[c & 15U] ^ (c >> 4);
    c = crc32c_internal::kNibbleTable[c & 15U] ^ (c >> 4);
  }
  return ~c;
}

}  // namespace wirepose

#endif  // WIREPOSE_MODEL_CRC32C_H_
