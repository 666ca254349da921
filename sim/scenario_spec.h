// What a scenario file says: a family of random scenes and how they are recorded. The values given
// here hold for keys that a file leaves out; scenario_file.h explains every key.
#ifndef WIREPOSE_SIM_SCENARIO_SPEC_H_
#define WIREPOSE_SIM_SCENARIO_SPEC_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/stereo_shot.h"
#include "sim/texture.h"

namespace wirepose::sim {

// A number drawn evenly from low..high.
struct Range {
  double low = 0, high = 0;
};

enum class RoomKind : std::uint8_t { kCounter, kTable, kShelf, kStudio };

struct RoomSpec {
  RoomKind kind = RoomKind::kCounter;
  std::vector<Texture> worktop = {Texture::kWood, Texture::kStone, Texture::kMarble, Texture::kPlain};
  Range worktop_albedo{0.2, 0.65};
  Range worktop_gloss{0, 0.06};
  std::vector<Texture> wall = {Texture::kTiles, Texture::kPlain, Texture::kWood};
  Range wall_albedo{0.25, 0.75};
  std::vector<Texture> cabinet = {Texture::kPlain, Texture::kWood};
  Range cabinet_albedo{0.15, 0.75};
};

enum class Support : std::uint8_t { kWorktop, kFloor, kOnRefrigerator };
enum class Rest : std::uint8_t { kAny, kUpright, kFlat };
enum class Print : std::uint8_t { kAny, kPrinted, kPlain };

// Where an object is, when it is not put down at random. World frame of the room: x to the right
// along the wall, y towards it, z up, origin in the middle of the worktop. Metres and degrees; R =
// Rz Ry Rx.
struct PoseSpec {
  std::array<Range, 3> position_m{};
  std::array<Range, 3> rotation_deg{};
};

struct ObjectSpec {
  std::vector<std::string> models;  // one of these is drawn for each instance; empty: any that fits
  Range count{1, 1};
  Support on = Support::kWorktop;
  Rest rest = Rest::kAny;
  std::optional<PoseSpec> pose;  // then `on`, `rest`, `x_m`, `y_m` and `yaw_deg` are not used
  Range x_m{-0.35, 0.35}, y_m{-0.25, 0.2};
  Range yaw_deg{-180, 180};
  Print print = Print::kAny;
  std::optional<Range> albedo;    // else it stands out from the worktop
  std::optional<Range> contrast;  // albedo differs by that much from the worktop's, to either side
  Range gloss{0, 0.04};
  Range scale{1, 1};           // of the model's size
  bool is_look_alike = false;  // no truth is written: finding it is a false alarm
  Range visible{0.3, 1};       // wanted visible fraction; layouts are drawn until it holds
};

// That many objects of any model that fits a worktop.
inline ObjectSpec AnyObjects(const Range& count) {
  ObjectSpec spec;
  spec.count = count;
  return spec;
}

struct ClutterSpec {
  Range count{3, 7};
  Range occluders{0, 0};    // things put between the camera and the first object
  Range reach_m{0.5, 0.5};  // how far from the middle clutter stands, along x
};

struct CameraSpec {
  StereoCalibration calibration = DefaultCalibration();
  Range distance_m{0.7, 1.6};
  Range elevation_deg{12, 42};
  Range azimuth_deg{-30, 30};
  Range roll_deg{-3, 3};
  Range aim_m{-0.08, 0.08};  // how far beside the objects it looks, along each axis
};

enum class PathKind : std::uint8_t { kStill, kOrbit, kDrive };

struct PathSpec {
  PathKind kind = PathKind::kOrbit;
  Range speed_m_per_s{0.08, 0.15};
  Range shake_deg{0, 0};  // amplitude of rotation at 5..9 Hz, as on a robot that rolls over joints
};

enum class LightStyle : std::uint8_t { kCeiling, kWindow, kLamp, kFlat, kUnderCabinet, kMixed };

struct LightSpec {
  std::vector<LightStyle> styles = {LightStyle::kCeiling, LightStyle::kWindow,       LightStyle::kLamp,
                                    LightStyle::kFlat,    LightStyle::kUnderCabinet, LightStyle::kMixed};
  Range ambient{0.5, 1.2};  // times the style's own
};

// Each eye draws its own blur; everything else is the same for both but `right_gain`.
struct SensorSpec {
  Range exposure_ms{1, 3};
  Range brightness{0.55, 0.95};  // of the full scale, for the brightest 3 % of the pixels
  Range white_e{5000, 12000};    // electrons of grey level 255
  Range read_noise_e{4, 12};
  double dark_e = 2;
  double prnu = 0.006, dsnu_e = 2;
  Range right_gain{0.85, 1.12};
  std::vector<double> gamma = {1, 2.2};
  Range psf_sigma_px{0.4, 0.7};
  Range vignetting{0.05, 0.3};
  Range veil{0, 0.03};  // stray light, of the mean light
};

enum class FaultKind : std::uint8_t {
  kDrop,          // the frame never comes: a gap in the sequence
  kDuplicate,     // the frame before once more, with a new number and stamp
  kFreeze,        // the images of the frame before the fault
  kSwap,          // left and right exchanged
  kTear,          // lower part from the frame before
  kBitFlip,       // bits flipped in `amount` of the bytes
  kOffset,        // right exposed `amount` ms after left
  kHiddenOffset,  // the same, and the stamps say nothing of it
  kExposure,      // light times `amount`
  kSmear,         // a greasy spot on the left lens
  kCover,         // something before the left lens
  kDrift,         // right camera turned by `amount` degrees against its calibration
  kDisconnect,    // the device is gone
  kClockStep,     // stamps jump by `amount` ms, and stay
};

struct FaultSpec {
  FaultKind kind = FaultKind::kDrop;
  std::uint64_t at = 0;      // first frame
  std::uint64_t frames = 1;  // how many
  double amount = 0;
};

struct FeedSpec {
  double stamp_jitter_us = 0;  // standard deviation of the right eye's lag
  std::vector<FaultSpec> faults;
};

struct ScenarioSpec {
  std::string name = "kitchen";
  std::string about;
  std::string source;      // text of the file that it was read from: what content hashes go by
  std::uint64_t seed = 1;  // of the first scene; the others count up
  int scenes = 1;
  int frames = 1;  // of each scene
  double rate_hz = 30;
  int samples = 16;  // rays a pixel: 4, 9, 16, 25 or 36
  RoomSpec room;
  std::vector<ObjectSpec> objects = {AnyObjects({1, 3})};
  ClutterSpec clutter;
  CameraSpec camera;
  PathSpec path;
  LightSpec lights;
  SensorSpec sensor;
  FeedSpec feed;
};

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_SCENARIO_SPEC_H_
