// A frame pack: calibration, models and raw frames in one file that needs no decoder, for targets without a file
// system.
#ifndef WIREPOSE_TESTS_TARGETS_FRAME_PACK_H_
#define WIREPOSE_TESTS_TARGETS_FRAME_PACK_H_

#include <array>
#include <cstdint>

#include "geometry/camera.h"

namespace wirepose::testing {

// Little-endian, in this order: PackHeader; for each model its size (8 bytes) and the .wpm file, padded with zeros to a
// multiple of 8; for each frame the left and the right image, width * height bytes each, row by row.
struct PackHeader {
  static constexpr std::uint64_t kMagic = 0x324B434150505257;  // "WRPPACK2"

  std::uint64_t magic = kMagic;
  std::uint32_t width = 0, height = 0;
  std::uint32_t models = 0, frames = 0;
  std::uint32_t hash_stages = 1;  // 0: recognize only, to count instructions
  std::uint32_t reserved = 0;
  std::array<std::array<double, 9>, 2> camera{};  // left, right: fx fy cx cy k1 k2 p1 p2 k3
  std::array<double, 9> R{};                      // of T_right_left, row by row
  std::array<double, 3> t{};                      // m
};
static_assert(sizeof(PackHeader) == 32 + 8 * (18 + 9 + 3), "no padding: the struct is the file's layout");

inline PackHeader HeaderOf(const StereoCalibration& c) {
  PackHeader header;
  header.width = static_cast<std::uint32_t>(c.width);
  header.height = static_cast<std::uint32_t>(c.height);
  const auto numbers = [](const CameraIntrinsics& k) {
    return std::array<double, 9>{k.fx, k.fy, k.cx, k.cy, k.k1, k.k2, k.p1, k.p2, k.k3};
  };
  header.camera = {numbers(c.left), numbers(c.right)};
  for (int i = 0; i < 9; ++i) header.R[static_cast<std::size_t>(i)] = c.T_right_left.R(i / 3, i % 3);
  for (int i = 0; i < 3; ++i) header.t[static_cast<std::size_t>(i)] = c.T_right_left.t(i);
  return header;
}

inline StereoCalibration CalibrationOf(const PackHeader& header) {
  StereoCalibration c;
  c.width = static_cast<int>(header.width);
  c.height = static_cast<int>(header.height);
  const auto intrinsics = [](const std::array<double, 9>& n) {
    return CameraIntrinsics{n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8]};
  };
  c.left = intrinsics(header.camera[0]);
  c.right = intrinsics(header.camera[1]);
  for (int i = 0; i < 9; ++i) c.T_right_left.R(i / 3, i % 3) = header.R[static_cast<std::size_t>(i)];
  for (int i = 0; i < 3; ++i) c.T_right_left.t(i) = header.t[static_cast<std::size_t>(i)];
  return c;
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_TARGETS_FRAME_PACK_H_
