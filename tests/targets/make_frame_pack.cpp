// Packs a data set for frame_hashes: make_frame_pack DATASET OUT FRAMES MODEL.wpm...
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <span>
#include <vector>

#include "hal/dataset/dataset.h"
#include "tests/targets/frame_pack.h"

namespace wirepose::testing {
namespace {

template <typename T>
void Write(std::ofstream& out, const T* data, std::size_t count) {
  out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(count * sizeof(T)));
}

std::string WriteModel(const char* file, std::ofstream& out) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  if (bytes.empty()) return std::string(file) + ": cannot be read; make it with wirepose model build";
  const std::uint64_t size = bytes.size();
  Write(out, &size, 1);
  bytes.resize((bytes.size() + 7) / 8 * 8);
  Write(out, bytes.data(), bytes.size());
  return {};
}

std::string WriteFrame(const dataset::FrameEntry& frame, const PackHeader& header, std::ofstream& out) {
  for (const auto& path : {frame.left_path, frame.right_path}) {
    const auto image = dataset::ReadGrayPng(path);
    if (!image) return image.error().message;
    if (image->pixels.size() != std::size_t{header.width} * header.height) {
      return path.string() + ": not of the calibrated size; record it again";
    }
    Write(out, image->pixels.data(), image->pixels.size());
  }
  return {};
}

// Empty, or what went wrong in one line.
std::string Pack(const char* folder, const char* file, std::size_t frames, std::span<char*> models) {
  const auto dataset = dataset::ReadDataset(folder);
  if (!dataset) return dataset.error();
  if (dataset->frames.size() < frames) return std::string(folder) + ": has fewer frames; render more";
  std::ofstream out(file, std::ios::binary);
  PackHeader header = HeaderOf(dataset->calibration);
  header.models = static_cast<std::uint32_t>(models.size());
  header.frames = static_cast<std::uint32_t>(frames);
  Write(out, &header, 1);
  for (const char* model : models) {
    if (std::string error = WriteModel(model, out); !error.empty()) return error;
  }
  for (std::size_t i = 0; i < frames; ++i) {
    if (std::string error = WriteFrame(dataset->frames[i], header, out); !error.empty()) return error;
  }
  return out.flush() ? std::string() : std::string(file) + ": cannot be written; check the folder and the disk";
}

}  // namespace
}  // namespace wirepose::testing

int main(int argc, char** argv) {
  if (argc < 5) {
    std::cerr << "usage: make_frame_pack DATASET OUT FRAMES MODEL.wpm...\n";
    return 2;
  }
  const std::span<char*> arguments(argv, static_cast<std::size_t>(argc));
  const auto frames = static_cast<std::size_t>(std::max(0, std::atoi(argv[3])));
  const std::string error = wirepose::testing::Pack(argv[1], argv[2], frames, arguments.subspan(4));
  if (!error.empty()) std::cerr << "make_frame_pack: " << error << "\n";
  return error.empty() ? 0 : 1;
}
