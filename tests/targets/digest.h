// FNV-1a over values as bytes, little-endian: names the output of a stage in 16 digits.
#ifndef WIREPOSE_TESTS_TARGETS_DIGEST_H_
#define WIREPOSE_TESTS_TARGETS_DIGEST_H_

#include <bit>
#include <concepts>
#include <cstdint>
#include <type_traits>

#include "base/image_view.h"
#include "geometry/se3.h"

namespace wirepose::testing {

class Digest {
 public:
  void Byte(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001B3ULL; }

  template <std::unsigned_integral T>
  void Add(T number) {
    for (std::size_t i = 0; i < sizeof(T); ++i) Byte(static_cast<std::uint8_t>(number >> (8 * i)));
  }
  template <typename T>
  requires std::is_enum_v<T>
  void Add(T value) { Add(static_cast<std::make_unsigned_t<std::underlying_type_t<T>>>(value)); }
  void Add(bool value) { Byte(value ? 1 : 0); }
  void Add(float value) { Add(std::bit_cast<std::uint32_t>(value)); }
  void Add(double value) { Add(std::bit_cast<std::uint64_t>(value)); }
  template <typename T, int kRows, int kColumns>
  void Add(const Eigen::Matrix<T, kRows, kColumns>& matrix) {
    for (int i = 0; i < matrix.size(); ++i) Add(matrix.data()[i]);
  }
  void Add(const Pose& pose) {
    Add(pose.R);
    Add(pose.t);
  }
  void Add(ImageView image) {
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) Byte(image.row(y)[x]);
    }
  }
  template <typename... T>
  requires(sizeof...(T) > 1) void Add(const T&... values) { (Add(values), ...); }

  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325ULL;
};

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_TARGETS_DIGEST_H_
