// Runs the recognizer core on a frame pack and prints a hash of what every stage gave, the serialized results' hash and
// the detections. Two builds are equal when they print the same text; tests/targets/README.md says how to compare.
#include <algorithm>
#include <array>

#include "model/model_parser.h"
#include "pipeline/recognizer.h"
#include "tests/targets/frame_pack.h"
#include "tests/targets/result_bytes.h"
#include "tests/targets/stage_hasher.h"
#include "tests/targets/target_io.h"

namespace wirepose::testing {
namespace {

constexpr std::size_t kMaxModelBytes = 64 * 1024;  // a juice dispenser's file has 60 KiB
constexpr std::size_t kMaxPackModels = 4;

Recognizer g_recognizer;
RecognitionResult g_result;
std::array<std::uint8_t, kMaxPixels> g_left, g_right;
alignas(kModelAlignment) std::array<std::array<std::byte, kMaxModelBytes>, kMaxPackModels> g_models;

bool Fail(const char* what) {
  Print("frame_hashes: ");
  Print(kPackFile);
  Print(": ");
  Print(what);
  Print("; make the file with make_frame_pack\n");
  return false;
}

bool LoadModels(std::uint32_t count) {
  if (count > kMaxPackModels) return Fail("more models than this program has memory for");
  for (std::uint32_t m = 0; m < count; ++m) {
    std::uint64_t size = 0;
    if (!ReadPack(&size, sizeof(size))) return Fail("ends within the models");
    const std::size_t padded = (static_cast<std::size_t>(size) + 7) / 8 * 8;
    if (size > kMaxModelBytes || !ReadPack(g_models[m].data(), padded)) return Fail("holds a model that is too large");
    const auto model = ParseModel({g_models[m].data(), static_cast<std::size_t>(size)});
    if (!model) return Fail(Describe(model.error()));
    const RecognizerError error = g_recognizer.AddModel(*model);
    if (error != RecognizerError::kOk) return Fail(Describe(error));
  }
  return true;
}

void PrintHash(std::uint32_t frame, const char* name, std::uint64_t hash) {
  Print("frame ");
  PrintNumber(frame);
  Print(" ");
  Print(name);
  Print(" ");
  PrintHex(hash, 16);
  Print("\n");
}

void PrintDetections(std::uint32_t frame) {
  for (const Detection& d : g_result.detections) {
    Print("frame ");
    PrintNumber(frame);
    Print(" detection model ");
    PrintNumber(d.model_id);
    Print(" score_permille ");
    PrintNumber(static_cast<std::int64_t>(d.score * 1000));
    Print(" translation_um");
    for (int i = 0; i < 3; ++i) {
      Print(" ");
      PrintNumber(static_cast<std::int64_t>(d.T_camera_model.t(i) * 1e6));
    }
    Print("\n");
  }
}

bool ProcessFrame(std::uint32_t frame, const PackHeader& header, StageHasher& hasher) {
  const auto width = static_cast<int>(header.width), height = static_cast<int>(header.height);
  const std::size_t pixels = static_cast<std::size_t>(header.width) * header.height;
  if (!ReadPack(g_left.data(), pixels) || !ReadPack(g_right.data(), pixels)) return Fail("ends within the frames");
  hasher.FrameBegins();
  StageObserver* const observer = header.hash_stages != 0 ? &hasher : nullptr;
  const RecognizerError error = g_recognizer.Process({g_left.data(), width, height, width},
                                                     {g_right.data(), width, height, width}, observer, g_result);
  if (error != RecognizerError::kOk) return Fail(Describe(error));
  if (header.hash_stages == 0) return true;
  for (std::size_t s = 0; s < kStageCount; ++s) {
    const auto stage = static_cast<Stage>(s);
    if (stage != Stage::kRefine && stage != Stage::kSelect) PrintHash(frame, StageName(stage), hasher.Hash(stage));
  }
  Digest bytes;
  Serialize(g_result, bytes);
  PrintHash(frame, "result", bytes.value());
  PrintDetections(frame);
  return true;
}

bool Run() {
  PackHeader header;
  if (!OpenPack()) return Fail("cannot be opened");
  if (!ReadPack(&header, sizeof(header)) || header.magic != PackHeader::kMagic) return Fail("is no frame pack");
  const RecognizerError error = g_recognizer.Configure(CalibrationOf(header));
  if (error != RecognizerError::kOk) return Fail(Describe(error));
  if (!LoadModels(header.models)) return false;
  StageHasher hasher(g_recognizer);
  for (std::uint32_t frame = 0; frame < header.frames; ++frame) {
    if (!ProcessFrame(frame, header, hasher)) return false;
  }
  PrintMemoryMap();
  return true;
}

}  // namespace

int RunTarget() { return Run() ? 0 : 1; }

}  // namespace wirepose::testing
