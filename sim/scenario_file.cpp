#include "sim/scenario_file.h"

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "hal/dataset/calibration_file.h"
#include "yaml/yaml_section.h"

namespace wirepose::sim {
namespace {

using yaml::YamlSection;

template <typename T>
using Words = std::map<std::string, T>;

const Words<Texture> kTextures = {{"plain", Texture::kPlain}, {"wood", Texture::kWood},     {"stone", Texture::kStone},
                                  {"tiles", Texture::kTiles}, {"marble", Texture::kMarble}, {"steel", Texture::kSteel}};
const Words<RoomKind> kRooms = {{"counter", RoomKind::kCounter},
                                {"table", RoomKind::kTable},
                                {"shelf", RoomKind::kShelf},
                                {"studio", RoomKind::kStudio}};
const Words<Support> kSupports = {
    {"worktop", Support::kWorktop}, {"floor", Support::kFloor}, {"refrigerator", Support::kOnRefrigerator}};
const Words<Rest> kRests = {{"any", Rest::kAny}, {"upright", Rest::kUpright}, {"flat", Rest::kFlat}};
const Words<Print> kPrints = {{"any", Print::kAny}, {"printed", Print::kPrinted}, {"plain", Print::kPlain}};
const Words<PathKind> kPaths = {{"still", PathKind::kStill}, {"orbit", PathKind::kOrbit}, {"drive", PathKind::kDrive}};
const Words<LightStyle> kLights = {{"ceiling", LightStyle::kCeiling},
                                   {"window", LightStyle::kWindow},
                                   {"lamp", LightStyle::kLamp},
                                   {"flat", LightStyle::kFlat},
                                   {"under_cabinet", LightStyle::kUnderCabinet},
                                   {"mixed", LightStyle::kMixed}};
const Words<FaultKind> kFaults = {{"drop", FaultKind::kDrop},
                                  {"duplicate", FaultKind::kDuplicate},
                                  {"freeze", FaultKind::kFreeze},
                                  {"swap", FaultKind::kSwap},
                                  {"tear", FaultKind::kTear},
                                  {"bit_flip", FaultKind::kBitFlip},
                                  {"offset", FaultKind::kOffset},
                                  {"exposure", FaultKind::kExposure},
                                  {"smear", FaultKind::kSmear},
                                  {"cover", FaultKind::kCover},
                                  {"drift", FaultKind::kDrift},
                                  {"disconnect", FaultKind::kDisconnect},
                                  {"clock_step", FaultKind::kClockStep},
                                  {"hidden_offset", FaultKind::kHiddenOffset}};

template <typename T>
T Word(const YamlSection& section, const std::string& key, const std::string& word, const Words<T>& known) {
  const auto found = known.find(word);
  if (found != known.end()) return found->second;
  std::string names;
  for (const auto& [name, value] : known) names += (names.empty() ? "" : ", ") + name;
  section.Refuse(key, "no '" + word + "'; choose from " + names);
}

template <typename T>
void ReadWord(YamlSection& section, const std::string& key, T& value, const Words<T>& known) {
  std::string word;
  if (section.Read(key, word)) value = Word(section, key, word, known);
}

template <typename T>
void ReadWords(YamlSection& section, const std::string& key, std::vector<T>& value, const Words<T>& known) {
  std::vector<std::string> words;
  if (!section.Read(key, words)) return;
  value.clear();
  for (const std::string& word : words) value.push_back(Word(section, key, word, known));
}

bool ReadRange(YamlSection& section, const std::string& key, Range& range, double least, double most) {
  return section.ReadRange(key, range.low, range.high, least, most);
}

void ReadRange(YamlSection& section, const std::string& key, std::optional<Range>& range, double least, double most) {
  Range read;
  if (ReadRange(section, key, read, least, most)) range = read;
}

void ReadInt(YamlSection& section, const std::string& key, int& value, int least, int most) {
  std::int64_t number = value;
  section.Read(key, number, least, most);
  value = static_cast<int>(number);
}

RoomSpec ReadRoom(YamlSection section) {
  RoomSpec room;
  ReadWord(section, "kind", room.kind, kRooms);
  ReadWords(section, "worktop", room.worktop, kTextures);
  ReadRange(section, "worktop_albedo", room.worktop_albedo, 0, 1);
  ReadRange(section, "worktop_gloss", room.worktop_gloss, 0, 1);
  ReadWords(section, "wall", room.wall, kTextures);
  ReadRange(section, "wall_albedo", room.wall_albedo, 0, 1);
  ReadWords(section, "cabinet", room.cabinet, kTextures);
  ReadRange(section, "cabinet_albedo", room.cabinet_albedo, 0, 1);
  section.Finish();
  return room;
}

std::array<Range, 3> ReadAxes(YamlSection section, double most) {
  std::array<Range, 3> axes{};
  ReadRange(section, "x", axes[0], -most, most);
  ReadRange(section, "y", axes[1], -most, most);
  ReadRange(section, "z", axes[2], -most, most);
  section.Finish();
  return axes;
}

ObjectSpec ReadObject(YamlSection section) {
  ObjectSpec object;
  section.Read("model", object.models);
  ReadRange(section, "count", object.count, 0, 20);
  ReadWord(section, "on", object.on, kSupports);
  ReadWord(section, "rest", object.rest, kRests);
  if (section.Has("position_m") || section.Has("rotation_deg")) {
    object.pose = PoseSpec{ReadAxes(section.Section("position_m"), 10), ReadAxes(section.Section("rotation_deg"), 360)};
  }
  ReadRange(section, "x_m", object.x_m, -3, 3);
  ReadRange(section, "y_m", object.y_m, -3, 3);
  ReadRange(section, "yaw_deg", object.yaw_deg, -360, 360);
  ReadWord(section, "print", object.print, kPrints);
  ReadRange(section, "albedo", object.albedo, 0, 1);
  ReadRange(section, "contrast", object.contrast, 0, 1);
  ReadRange(section, "gloss", object.gloss, 0, 1);
  ReadRange(section, "scale", object.scale, 0.1, 10);
  section.Read("look_alike", object.is_look_alike);
  ReadRange(section, "visible", object.visible, 0, 1);
  const bool is_scaled = object.scale.low != 1 || object.scale.high != 1;
  if (is_scaled && !object.is_look_alike) {
    section.Refuse("scale", "an object of another size is not the model; write look_alike: true as well");
  }
  section.Finish();
  return object;
}

ClutterSpec ReadClutter(YamlSection section) {
  ClutterSpec clutter;
  ReadRange(section, "count", clutter.count, 0, 40);
  ReadRange(section, "occluders", clutter.occluders, 0, 10);
  ReadRange(section, "reach_m", clutter.reach_m, 0.1, 3);
  section.Finish();
  return clutter;
}

// A rig without distortion, eyes alike and parallel, unless `calibration` names a file.
void ReadRig(YamlSection section, StereoCalibration& c) {
  double focal_px = 525, baseline_m = 0.12, k1 = 0;
  ReadInt(section, "width", c.width, 64, 4096);
  ReadInt(section, "height", c.height, 48, 4096);
  section.Read("focal_px", focal_px, 50, 10000);
  section.Read("baseline_m", baseline_m, 0.001, 2);
  section.Read("k1", k1, -0.5, 0.5);
  section.Finish();
  c.left = c.right = {focal_px, focal_px, 0.5 * (c.width - 1), 0.5 * (c.height - 1), k1};
  c.T_right_left = Pose{};
  c.T_right_left.t.x() = -baseline_m;
}

CameraSpec ReadCamera(YamlSection section) {
  CameraSpec camera;
  std::filesystem::path calibration;
  if (section.Has("rig")) ReadRig(section.Section("rig"), camera.calibration);
  if (section.Read("calibration", calibration)) {
    const Result<StereoCalibration, std::string> read = dataset::ReadCalibration(calibration);
    if (!read) section.Refuse("calibration", read.error());
    camera.calibration = *read;
  }
  ReadRange(section, "distance_m", camera.distance_m, 0.2, 6);
  ReadRange(section, "elevation_deg", camera.elevation_deg, -30, 80);
  ReadRange(section, "azimuth_deg", camera.azimuth_deg, -80, 80);
  ReadRange(section, "roll_deg", camera.roll_deg, -45, 45);
  ReadRange(section, "aim_m", camera.aim_m, -2, 2);
  section.Finish();
  return camera;
}

PathSpec ReadPath(YamlSection section) {
  PathSpec path;
  ReadWord(section, "kind", path.kind, kPaths);
  ReadRange(section, "speed_m_per_s", path.speed_m_per_s, 0, 3);
  ReadRange(section, "shake_deg", path.shake_deg, 0, 5);
  section.Finish();
  return path;
}

LightSpec ReadLights(YamlSection section) {
  LightSpec lights;
  ReadWords(section, "style", lights.styles, kLights);
  ReadRange(section, "ambient", lights.ambient, 0, 10);
  section.Finish();
  return lights;
}

SensorSpec ReadSensor(YamlSection section) {
  SensorSpec sensor;
  ReadRange(section, "exposure_ms", sensor.exposure_ms, 0, 100);
  ReadRange(section, "brightness", sensor.brightness, 0.01, 2);
  ReadRange(section, "white_e", sensor.white_e, 100, 1e6);
  ReadRange(section, "read_noise_e", sensor.read_noise_e, 0, 1000);
  section.Read("dark_e", sensor.dark_e, 0, 10000);
  section.Read("prnu", sensor.prnu, 0, 0.5);
  section.Read("dsnu_e", sensor.dsnu_e, 0, 1000);
  ReadRange(section, "right_gain", sensor.right_gain, 0.2, 5);
  section.Read("gamma", sensor.gamma, 0.3, 4);
  ReadRange(section, "psf_sigma_px", sensor.psf_sigma_px, 0, 2);
  ReadRange(section, "vignetting", sensor.vignetting, 0, 0.9);
  ReadRange(section, "veil", sensor.veil, 0, 5);
  section.Finish();
  return sensor;
}

FaultSpec ReadFault(YamlSection section) {
  FaultSpec fault;
  std::int64_t at = 0, frames = 1;
  if (!section.Has("fault")) section.Refuse("fault", "missing; say what happens");
  ReadWord(section, "fault", fault.kind, kFaults);
  section.Read("at", at, 0, 1'000'000'000);
  section.Read("frames", frames, 1, 1'000'000'000);
  const bool has_amount = section.Read("amount", fault.amount, -10000, 10000);
  static const std::set<FaultKind> needing = {FaultKind::kBitFlip,  FaultKind::kOffset, FaultKind::kHiddenOffset,
                                              FaultKind::kExposure, FaultKind::kDrift,  FaultKind::kClockStep};
  if (needing.contains(fault.kind) && !has_amount) section.Refuse("amount", "missing; this fault needs one");
  section.Finish();
  fault.at = static_cast<std::uint64_t>(at);
  fault.frames = static_cast<std::uint64_t>(frames);
  return fault;
}

FeedSpec ReadFeed(YamlSection section) {
  FeedSpec feed;
  section.Read("stamp_jitter_us", feed.stamp_jitter_us, 0, 100000);
  for (YamlSection& fault : section.Sections("faults")) feed.faults.push_back(ReadFault(std::move(fault)));
  section.Finish();
  return feed;
}

ScenarioSpec Read(const std::filesystem::path& file) {
  YamlSection section(file);
  ScenarioSpec spec;
  spec.name = file.stem().string();
  spec.source = (std::ostringstream() << std::ifstream(file).rdbuf()).str();
  std::int64_t seed = 1;
  section.Read("about", spec.about);
  section.Read("seed", seed, 0, 1'000'000'000);
  spec.seed = static_cast<std::uint64_t>(seed);
  ReadInt(section, "scenes", spec.scenes, 1, 100000);
  ReadInt(section, "frames", spec.frames, 1, 100000);
  section.Read("rate_hz", spec.rate_hz, 1, 1000);
  ReadInt(section, "samples", spec.samples, 4, 36);
  static const std::set<int> squares = {4, 9, 16, 25, 36};
  if (!squares.contains(spec.samples)) section.Refuse("samples", "not 4, 9, 16, 25 or 36 rays a pixel");
  spec.room = ReadRoom(section.Section("room"));
  if (section.Has("objects")) {
    spec.objects.clear();
    for (YamlSection& object : section.Sections("objects")) spec.objects.push_back(ReadObject(std::move(object)));
  }
  spec.clutter = ReadClutter(section.Section("clutter"));
  spec.camera = ReadCamera(section.Section("camera"));
  spec.path = ReadPath(section.Section("path"));
  spec.lights = ReadLights(section.Section("lights"));
  spec.sensor = ReadSensor(section.Section("sensor"));
  spec.feed = ReadFeed(section.Section("feed"));
  section.Finish();
  return spec;
}

}  // namespace

Result<ScenarioSpec, std::string> ReadScenario(const std::filesystem::path& file) {
  try {
    return Read(file);
  } catch (const yaml::YamlError& error) {
    return unexpected<std::string>(error.what());
  }
}

}  // namespace wirepose::sim
