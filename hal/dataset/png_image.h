// PNG files to and from memory. Grey levels are taken as they are: no gamma, no colour management.
#ifndef WIREPOSE_HAL_DATASET_PNG_IMAGE_H_
#define WIREPOSE_HAL_DATASET_PNG_IMAGE_H_

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/image_view.h"
#include "base/result.h"

namespace wirepose::dataset {

// An image that owns its pixels: row-major, without padding.
template <typename T>
struct OwnedImage {
  int width = 0;
  int height = 0;
  std::vector<T> pixels;

  [[nodiscard]] BasicImageView<const T> view() const { return {pixels.data(), width, height, width}; }
  [[nodiscard]] BasicImageView<T> mutable_view() { return {pixels.data(), width, height, width}; }
};

using GrayImage = OwnedImage<std::uint8_t>;
using DepthImage = OwnedImage<std::uint16_t>;

// Why an image could not be read. `message` is one line: "file: what; remedy".
struct ImageError {
  bool missing = false;  // there is no such file; false: it is there and cannot be used
  std::string message;
};

// Reads an 8 bit image (less than 8 bit is widened). Colour becomes grey by the weights of ITU-R
// BT.601, alpha is dropped. 16 bit images are refused. Allocates. At most 16384 x 16384 pixels and
// 64 megapixels.
[[nodiscard]] Result<GrayImage, ImageError> ReadGrayPng(const std::filesystem::path& path);

// Reads a 16 bit grey image (depth in units of the data set's depth_scale); any other kind is
// refused.
[[nodiscard]] Result<DepthImage, ImageError> ReadDepthPng(const std::filesystem::path& path);

// Write 8 and 16 bit grey images. The folder must exist. The error is one line as above.
[[nodiscard]] Result<void, std::string> WriteGrayPng(const std::filesystem::path& path, ImageView image);
[[nodiscard]] Result<void, std::string> WriteDepthPng(const std::filesystem::path& path,
                                                      BasicImageView<const std::uint16_t> image);

}  // namespace wirepose::dataset

#endif  // WIREPOSE_HAL_DATASET_PNG_IMAGE_H_
