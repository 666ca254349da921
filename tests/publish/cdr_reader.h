// Reads plain CDR (OMG DDSI-RTPS 2.2 section 10, XCDR1 little-endian) field by field. Written from
// the specification, without DDS: it checks what is on the wire, not what our DDS library makes of
// it.
#ifndef WIREPOSE_TESTS_PUBLISH_CDR_READER_H_
#define WIREPOSE_TESTS_PUBLISH_CDR_READER_H_

#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>

namespace wirepose::test {

class CdrReader {
 public:
  // `bytes` begin with the 4 byte encapsulation header; offsets for alignment count from behind it.
  explicit CdrReader(std::span<const unsigned char> bytes) : bytes_(bytes) {
    if (bytes.size() < 4 || bytes[0] != 0x00 || bytes[1] != 0x01) {
      throw std::runtime_error("encapsulation is not CDR_LE (00 01)");
    }
    bytes_ = bytes_.subspan(4);
  }

  // A number aligned to its size (at most 8), least significant byte first.
  template <typename T>
  T Read() {
    while (at_ % sizeof(T) != 0) Byte();
    unsigned char raw[sizeof(T)];
    for (unsigned char& b : raw) b = Byte();
    T value;
    std::memcpy(&value, raw, sizeof value);  // the test machine is little-endian too
    return value;
  }

  // 32 bit length that counts the terminating zero, then the characters.
  std::string ReadString() {
    const auto size = Read<std::uint32_t>();
    std::string text;
    for (std::uint32_t i = 0; i < size; ++i) text += static_cast<char>(Byte());
    if (text.empty() || text.back() != '\0') throw std::runtime_error("string without its zero");
    text.pop_back();
    return text;
  }

  // Only padding to a multiple of 4 may be left.
  [[nodiscard]] bool AtEnd() const { return bytes_.size() - at_ < 4; }

 private:
  unsigned char Byte() {
    if (at_ >= bytes_.size()) throw std::runtime_error("message too short");
    return bytes_[at_++];
  }

  std::span<const unsigned char> bytes_;
  std::size_t at_ = 0;
};

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_PUBLISH_CDR_READER_H_
