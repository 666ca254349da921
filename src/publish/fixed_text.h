// Short text without heap.
#ifndef WIREPOSE_PUBLISH_FIXED_TEXT_H_
#define WIREPOSE_PUBLISH_FIXED_TEXT_H_

#include <array>
#include <cstddef>
#include <string_view>

namespace wirepose {

// Text in place, zero-terminated. Longer text is cut at the end of a whole UTF-8 character.
template <std::size_t kCapacity>
class FixedText {
 public:
  FixedText() = default;
  FixedText(std::string_view text) { *this = text; }  // NOLINT(google-explicit-constructor)
  FixedText& operator=(std::string_view text) {
    std::size_t size = text.size() < kCapacity ? text.size() : kCapacity - 1;
    // Bytes 10xxxxxx continue a character: do not cut before one.
    while (size < text.size() && size > 0 && (text[size] & '\xC0') == '\x80') --size;
    text.copy(chars_.data(), size);
    chars_[size] = '\0';
    return *this;
  }
  [[nodiscard]] const char* c_str() const { return chars_.data(); }
  operator std::string_view() const { return chars_.data(); }  // NOLINT(google-explicit-constructor)
  bool operator==(std::string_view other) const { return std::string_view(*this) == other; }
  bool operator==(const FixedText& other) const { return *this == std::string_view(other); }

 private:
  std::array<char, kCapacity> chars_{};
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_FIXED_TEXT_H_
