// A small data set and meshes on disk, made for one test and removed after it.
#ifndef WIREPOSE_TESTS_HAL_CONTRACT_TEST_DATA_H_
#define WIREPOSE_TESTS_HAL_CONTRACT_TEST_DATA_H_

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "hal/dataset/calibration_file.h"
#include "hal/dataset/dataset_writer.h"

namespace wirepose::hal::test {

namespace fs = std::filesystem;

// A folder of its own for each object of this class.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static int count = 0;
    path_ = fs::temp_directory_path() / ("wirepose_hal_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    fs::create_directories(path_);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

constexpr int kWidth = 160, kHeight = 120;

inline StereoCalibration SmallCalibration() {
  StereoCalibration c;
  c.width = kWidth;
  c.height = kHeight;
  c.left = {131.25, 131.5, 79.6, 60.5, -0.083, 0.021, 0.0004, -0.0003, 0.001};
  c.right = {131.75, 132.0, 80.3, 59.8, -0.080, 0.018, -0.0002, 0.0005, -0.002};
  c.T_right_left.R = Eigen::AngleAxisd(0.005, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  c.T_right_left.t = Vector3d(-0.12, 0.0006, -0.0004);
  return c;
}

// Every byte depends on frame and eye.
inline dataset::GrayImage Pattern(int frame, int eye) {
  dataset::GrayImage image{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight)};
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] =
        static_cast<std::uint8_t>(i * 7 + i / kWidth * 13 + static_cast<std::size_t>(frame * 31 + eye * 101));
  }
  return image;
}

inline void OrThrow(const Result<void, std::string>& result) {
  if (!result) throw std::runtime_error(result.error());
}

// Scenes 1 and 2 with `frames` frames each; one object in each frame. Frame numbers go on from
// scene to scene in Pattern.
inline void WriteDataset(const fs::path& root, int frames) {
  auto writer = dataset::DatasetWriter::Create(root, SmallCalibration()).value();
  for (int scene = 1; scene <= 2; ++scene) {
    for (int i = 0; i < frames; ++i) {
      const int number = (scene - 1) * frames + i;
      dataset::FrameRecord record;
      record.im_id = i;
      dataset::InstanceRecord instance;
      instance.obj_id = 3;
      instance.T_left_model.R = Eigen::AngleAxisd(0.1 * number, Vector3d::UnitY()).toRotationMatrix();
      instance.T_left_model.t = Vector3d(0.01 * number, -0.02, 0.9);
      instance.px_count_all = 200;
      instance.px_count_in_image = 180;
      instance.px_count_visib = 100 + number;
      instance.visib_fract = instance.px_count_visib / 200.0;
      record.instances = {instance};
      OrThrow(writer.AddFrame(scene, record, Pattern(number, 0).view(), Pattern(number, 1).view(), {}));
    }
    OrThrow(writer.FinishScene(scene));
  }
}

// A mesh that the simulator finds: a box of 300 x 200 x 150 mm.
inline void WriteBoxMesh(const fs::path& folder) {
  fs::create_directories(folder);
  std::ofstream out(folder / "parcel_box.obj");
  for (const int z : {-75, 75}) {
    for (const int y : {-100, 100}) {
      for (const int x : {-150, 150}) out << "v " << x << ' ' << y << ' ' << z << '\n';
    }
  }
  out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

inline std::string ReadText(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

inline void WriteText(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

}  // namespace wirepose::hal::test

#endif  // WIREPOSE_TESTS_HAL_CONTRACT_TEST_DATA_H_
