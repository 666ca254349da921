#include "sim/contact_sheet.h"

#include <algorithm>

#include "hal/dataset/dataset.h"

namespace wirepose::sim {
namespace {

constexpr std::size_t kMost = 30, kColumns = 5;
constexpr int kShrink = 2, kBorder = 4;  // px

// The mean of each kShrink x kShrink block at (x0, y0) of the sheet.
void Paste(const dataset::GrayImage& image, int x0, int y0, dataset::GrayImage& sheet) {
  for (int y = 0; y < image.height / kShrink; ++y) {
    for (int x = 0; x < image.width / kShrink; ++x) {
      int sum = 0;
      for (int dy = 0; dy < kShrink; ++dy) {
        for (int dx = 0; dx < kShrink; ++dx) {
          sum += image.pixels[static_cast<std::size_t>((y * kShrink + dy) * image.width + x * kShrink + dx)];
        }
      }
      sheet.pixels[static_cast<std::size_t>((y0 + y) * sheet.width + x0 + x)] =
          static_cast<std::uint8_t>(sum / (kShrink * kShrink));
    }
  }
}

}  // namespace

Result<void, std::string> WriteContactSheet(const std::filesystem::path& dataset_root,
                                            const std::filesystem::path& png) {
  const Result<dataset::Dataset, std::string> set = dataset::ReadDataset(dataset_root);
  if (!set) return unexpected(set.error());
  const std::size_t count = std::min(kMost, set->frames.size()), columns = std::min(kColumns, count);
  const int width = set->calibration.width / kShrink + kBorder, height = set->calibration.height / kShrink + kBorder;
  const std::size_t rows = (count + columns - 1) / columns;
  dataset::GrayImage sheet{static_cast<int>(columns) * width + kBorder, static_cast<int>(rows) * height + kBorder, {}};
  sheet.pixels.assign(static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), 255);
  for (std::size_t i = 0; i < count; ++i) {
    const dataset::FrameEntry& frame = set->frames[i * set->frames.size() / count];
    const Result<dataset::GrayImage, dataset::ImageError> image = dataset::ReadGrayPng(frame.left_path);
    if (!image) return unexpected(image.error().message);
    Paste(*image, kBorder + static_cast<int>(i % columns) * width, kBorder + static_cast<int>(i / columns) * height,
          sheet);
  }
  return dataset::WriteGrayPng(png, sheet.view());
}

}  // namespace wirepose::sim
