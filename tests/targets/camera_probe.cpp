// What the libcamera backend gives on a board, as hashes: camera_probe CALIB LEFT RIGHT FORMAT FRAMES MODEL.wpm...
// One line a frame: status, skew, and the hash of the serialized recognition result, which frame_hashes prints for the
// same images.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "hal/libcamera/libcamera_camera.h"
#include "model/model_parser.h"
#include "pipeline/recognizer.h"
#include "tests/targets/digest.h"
#include "tests/targets/result_bytes.h"

namespace wirepose::testing {
namespace {

Recognizer g_recognizer;
RecognitionResult g_result;

// The bytes stay where they are until the program ends.
bool AddModel(const char* file, std::vector<std::vector<std::uint64_t>>& storage) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::size_t>(std::max<std::streamoff>(0, in.tellg()));
  std::vector<std::uint64_t>& words = storage.emplace_back((size + 7) / 8);
  in.seekg(0);
  in.read(reinterpret_cast<char*>(words.data()), static_cast<std::streamsize>(size));
  const auto model = ParseModel(std::as_bytes(std::span(words)).first(size));
  if (model && g_recognizer.AddModel(*model) == RecognizerError::kOk) return true;
  std::fprintf(stderr, "camera_probe: %s: no model that can be used\n", file);
  return false;
}

void Print(const hal::StereoFrame& frame) {
  Digest digest;
  if (frame.status == hal::FrameStatus::kGood &&
      g_recognizer.Process(frame.left, frame.right, nullptr, g_result) == RecognizerError::kOk) {
    Serialize(g_result, digest);
  }
  std::printf("sequence %llu %s skew_us %lld result %016llx\n", static_cast<unsigned long long>(frame.sequence),
              hal::Describe(frame.status), static_cast<long long>(frame.right_minus_left.count() / 1000),
              static_cast<unsigned long long>(digest.value()));
  std::fflush(stdout);
}

int Fail(hal::StereoCamera& camera, hal::CameraError error) {
  std::fprintf(stderr, "camera_probe: %s: %s\n", hal::Describe(error), std::string(camera.detail()).c_str());
  return 1;
}

int Run(std::span<char*> arguments) {
  hal::LibcameraConfig config;
  config.calibration_path = arguments[0];
  config.left = arguments[1];
  config.right = arguments[2];
  config.stream.pixel_format = arguments[3];
  config.max_skew = std::chrono::milliseconds(16);  // an emulated camera is as punctual as its host is idle
  const int frames = std::atoi(arguments[4]);
  hal::LibcameraCamera camera(config);
  if (const auto error = camera.Open(); error != hal::CameraError::kOk) return Fail(camera, error);
  if (g_recognizer.Configure(camera.calibration()) != RecognizerError::kOk) return 1;
  std::vector<std::vector<std::uint64_t>> storage;
  storage.reserve(arguments.size());
  for (char* file : arguments.subspan(5)) {
    if (!AddModel(file, storage)) return 1;
  }
  if (const auto error = camera.Start(); error != hal::CameraError::kOk) return Fail(camera, error);
  for (int i = 0; i < frames; ++i) {
    const auto lease = camera.AcquireFrame(std::chrono::seconds(10));
    if (!lease) return Fail(camera, lease.error());
    Print(lease->frame());
  }
  (void)camera.Stop();
  (void)camera.Close();
  std::puts("camera_probe: done");
  return 0;
}

}  // namespace
}  // namespace wirepose::testing

int main(int argc, char** argv) {
  if (argc < 6) {
    std::fprintf(stderr, "usage: camera_probe CALIB LEFT RIGHT FORMAT FRAMES MODEL.wpm...\n");
    return 2;
  }
  return wirepose::testing::Run(std::span(argv + 1, static_cast<std::size_t>(argc) - 1));
}
