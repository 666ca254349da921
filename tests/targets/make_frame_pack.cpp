// Packs a data set for frame_hashes: make_frame_pack [--no-hashes] DATASET OUT FRAMES MODEL.wpm...
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
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

struct Job {
  bool hash_stages = true;
  std::string folder, file;
  std::size_t frames = 0;
  std::span<char*> models;
};

// Empty, or what went wrong in one line.
std::string Pack(const Job& job) {
  const auto dataset = dataset::ReadDataset(job.folder);
  if (!dataset) return dataset.error();
  if (dataset->frames.size() < job.frames) return job.folder + ": has fewer frames; render more";
  std::ofstream out(job.file, std::ios::binary);
  PackHeader header = HeaderOf(dataset->calibration);
  header.models = static_cast<std::uint32_t>(job.models.size());
  header.frames = static_cast<std::uint32_t>(job.frames);
  header.hash_stages = job.hash_stages ? 1 : 0;
  Write(out, &header, 1);
  for (const char* model : job.models) {
    if (std::string error = WriteModel(model, out); !error.empty()) return error;
  }
  for (std::size_t i = 0; i < job.frames; ++i) {
    if (std::string error = WriteFrame(dataset->frames[i], header, out); !error.empty()) return error;
  }
  return out.flush() ? std::string() : job.file + ": cannot be written; check the folder and the disk";
}

}  // namespace
}  // namespace wirepose::testing

int main(int argc, char** argv) {
  std::span<char*> arguments(argv + 1, static_cast<std::size_t>(argc) - 1);
  wirepose::testing::Job job;
  if (!arguments.empty() && std::string_view(arguments[0]) == "--no-hashes") {
    job.hash_stages = false;
    arguments = arguments.subspan(1);
  }
  if (arguments.size() < 4) {
    std::cerr << "usage: make_frame_pack [--no-hashes] DATASET OUT FRAMES MODEL.wpm...\n";
    return 2;
  }
  job.folder = arguments[0];
  job.file = arguments[1];
  job.frames = static_cast<std::size_t>(std::max(0, std::atoi(arguments[2])));
  job.models = arguments.subspan(3);
  const std::string error = wirepose::testing::Pack(job);
  if (!error.empty()) std::cerr << "make_frame_pack: " << error << "\n";
  return error.empty() ? 0 : 1;
}
