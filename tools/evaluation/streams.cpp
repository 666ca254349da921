#include "tools/evaluation/streams.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace wirepose::evaluation {
namespace {

namespace fs = std::filesystem;
using InputJson = nlohmann::json;
using Outcome = Result<void, std::string>;

ObjectTruth FromModel(const ModelView& model) {
  ObjectTruth object;
  object.diameter_mm = static_cast<double>(model.diameter_m) * kMmPerMetre;
  for (std::size_t i = 0; i < model.vertices.size(); ++i) {
    object.vertices_mm.push_back(model.VertexPosition(i).cast<double>() * kMmPerMetre);
  }
  object.symmetries.push_back({});
  for (const ModelSymmetry& s : model.symmetries) {
    const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> R(s.rotation);
    const Eigen::Map<const Vector3> t(s.translation_m);
    object.symmetries.push_back({R.cast<double>(), t.cast<double>() * kMmPerMetre});
  }
  return object;
}

template <std::size_t kCount>
std::array<double, kCount> Numbers(const InputJson& json) {
  return json.get<std::array<double, kCount>>();
}

InstanceTruth ReadInstance(const InputJson& json) {
  InstanceTruth instance;
  instance.object_id = json.at("obj_id").get<int>();
  const auto R = Numbers<9>(json.at("R"));
  const auto t = Numbers<3>(json.at("t"));
  instance.T_camera_model.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  instance.T_camera_model.t_mm = Eigen::Map<const Vector3d>(t.data()) * kMmPerMetre;
  instance.visible_fraction = json.at("visib_fract").get<double>();
  return instance;
}

Estimate ReadDetection(const InputJson& json, int sequence) {
  Estimate e;
  e.image_id = sequence;
  e.object_id = json.at("model_id").get<int>();
  e.score = json.at("score").get<double>();
  const auto p = Numbers<3>(json.at("pose").at("position_m"));
  const auto q = Numbers<4>(json.at("pose").at("orientation_xyzw"));
  e.T_camera_model.R = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  e.T_camera_model.t_mm = Eigen::Map<const Vector3d>(p.data()) * kMmPerMetre;
  return e;
}

// Calls `use` with every line's JSON; a line that is not JSON or lacks what `use` asks of it is an
// error.
Outcome ForEachLine(const fs::path& file, const char* writer, const std::function<void(const InputJson&)>& use) {
  std::ifstream in(file);
  if (!in) return unexpected<std::string>(fmt::format("{}: cannot be opened; {} writes it", file.string(), writer));
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    try {
      use(InputJson::parse(line));
    } catch (const InputJson::exception& e) {
      return unexpected<std::string>(
          fmt::format("{}:{}: {}; give the file as {} wrote it", file.string(), number, e.what(), writer));
    }
  }
  return {};
}

}  // namespace

Result<GroundTruth, std::string> ReadTruthStream(const fs::path& file, const ModelSet& models) {
  GroundTruth truth;
  for (const ModelView& model : models.views) truth.objects.emplace(static_cast<int>(model.id), FromModel(model));
  const Outcome read = ForEachLine(file, "the simulated camera", [&](const InputJson& line) {
    FrameTruth frame;
    frame.image_id = line.at("sequence").get<int>();
    for (const InputJson& object : line.at("objects")) {
      const InstanceTruth instance = ReadInstance(object);
      if (truth.objects.contains(instance.object_id)) frame.instances.push_back(instance);
    }
    truth.frames.push_back(std::move(frame));
  });
  if (!read) return unexpected<std::string>(read.error());
  if (truth.frames.empty()) return unexpected<std::string>(file.string() + ": no frames; run the camera longer");
  std::ranges::sort(truth.frames, {}, &FrameTruth::image_id);
  return truth;
}

Result<Received, std::string> ReadReceivedStream(const fs::path& file) {
  Received received;
  const Outcome read = ForEachLine(file, "'wirepose watch --json'", [&](const InputJson& line) {
    if (!line.contains("frame_sequence")) return;
    const int sequence = line.at("frame_sequence").get<int>();
    received.frames.insert({0, sequence});
    for (const InputJson& d : line.at("detections")) received.estimates.push_back(ReadDetection(d, sequence));
  });
  if (!read) return unexpected<std::string>(read.error());
  if (!received.frames.empty()) return received;
  return unexpected<std::string>(file.string() +
                                 ": no message of wirepose/recognition; is wireposed running on this domain?");
}

}  // namespace wirepose::evaluation
