#include "hal/dataset/calibration_file.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <vector>

#include "geometry/rotation.h"
#include "hal/dataset/malformed.h"

namespace wirepose::dataset {
namespace {

constexpr int kMaxSide = 16384;
constexpr double kMinBaseline = 0.001, kMaxBaseline = 10;  // m

class CalibrationReader {
 public:
  CalibrationReader(std::string file, const YAML::Node& root) : file_(std::move(file)), root_(root) {
    if (!root_.IsMap()) {
      throw Malformed{file_ + ": not a calibration; write it with cv::FileStorage (K1 D1 ... T)"};
    }
  }

  StereoCalibration Read() {
    StereoCalibration c;
    c.width = Side("image_width");
    c.height = Side("image_height");
    c.left = Intrinsics("K1", "D1");
    c.right = Intrinsics("K2", "D2");
    c.T_right_left.R = Rotation("R");
    c.T_right_left.t = Translation("T");
    return c;
  }

 private:
  [[noreturn]] void Fail(const YAML::Node& node, const std::string& key, const std::string& what) const {
    const YAML::Mark mark = node.Mark();
    const std::string line = mark.is_null() ? "" : ":" + std::to_string(mark.line + 1);
    throw Malformed{file_ + line + ": " + key + ": " + what};
  }

  YAML::Node Find(const std::string& key) const {
    const YAML::Node node = root_[key];
    if (!node) throw Malformed{file_ + ": " + key + ": missing; calibrate the stereo rig again"};
    return node;
  }

  int Side(const std::string& key) const {
    const YAML::Node node = Find(key);
    int side = 0;
    if (!YAML::convert<int>::decode(node, side) || side < 1 || side > kMaxSide) {
      Fail(node, key, "not an image size from 1 to 16384; give the calibrated size in pixels");
    }
    return side;
  }

  struct Matrix {
    int rows = 0, cols = 0;
    std::vector<double> data;
  };

  Matrix ReadMatrix(const std::string& key, const YAML::Node& node) const {
    if (!node.IsMap() || !node["rows"] || !node["cols"] || !node["data"]) {
      Fail(node, key, "not an !!opencv-matrix with rows, cols and data");
    }
    Matrix m;
    if (!YAML::convert<int>::decode(node["rows"], m.rows) || !YAML::convert<int>::decode(node["cols"], m.cols) ||
        !node["data"].IsSequence()) {
      Fail(node, key, "rows and cols must be integers and data a list");
    }
    for (const YAML::Node& element : node["data"]) {
      double value = 0;
      if (!YAML::convert<double>::decode(element, value) || !std::isfinite(value)) {
        Fail(element, key, "not a finite number in data");
      }
      m.data.push_back(value);
    }
    if (m.rows < 0 || m.cols < 0 || m.rows > 64 || m.cols > 64 ||
        m.data.size() != static_cast<std::size_t>(m.rows) * static_cast<std::size_t>(m.cols)) {
      Fail(node, key, "data does not hold rows x cols numbers");
    }
    return m;
  }

  Matrix3d ReadMatrix3(const std::string& key, const YAML::Node& node) const {
    const Matrix m = ReadMatrix(key, node);
    if (m.rows != 3 || m.cols != 3) Fail(node, key, "not a 3 x 3 matrix");
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m.data.data());
  }

  CameraIntrinsics Intrinsics(const std::string& matrix_key, const std::string& distortion_key) const {
    const YAML::Node node = Find(matrix_key);
    const Matrix3d K = ReadMatrix3(matrix_key, node);
    if (K(0, 0) <= 0 || K(1, 1) <= 0) Fail(node, matrix_key, "focal length is not positive");
    if (K(0, 1) != 0 || K(1, 0) != 0 || K(2, 0) != 0 || K(2, 1) != 0 || K(2, 2) != 1) {
      Fail(node, matrix_key, "not of the form fx 0 cx 0 fy cy 0 0 1; skew is not supported");
    }
    CameraIntrinsics intrinsics{K(0, 0), K(1, 1), K(0, 2), K(1, 2)};
    ReadDistortion(distortion_key, intrinsics);
    return intrinsics;
  }

  // OpenCV's order: k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [taux tauy]]]].
  void ReadDistortion(const std::string& key, CameraIntrinsics& intrinsics) const {
    const YAML::Node node = Find(key);
    const Matrix m = ReadMatrix(key, node);
    if ((m.rows != 1 && m.cols != 1) || m.data.size() < 4) {
      Fail(node, key, "not a row of 4 or more distortion coefficients k1 k2 p1 p2 k3");
    }
    for (std::size_t i = 5; i < m.data.size(); ++i) {
      if (m.data[i] != 0) {
        Fail(node, key,
             "coefficient " + std::to_string(i + 1) +
                 " is not zero; only k1 k2 p1 p2 k3 are supported: calibrate with these five");
      }
    }
    intrinsics.k1 = m.data[0];
    intrinsics.k2 = m.data[1];
    intrinsics.p1 = m.data[2];
    intrinsics.p2 = m.data[3];
    intrinsics.k3 = m.data.size() > 4 ? m.data[4] : 0;
  }

  Matrix3d Rotation(const std::string& key) const {
    const YAML::Node node = Find(key);
    const Matrix3d R = ReadMatrix3(key, node);
    if (!IsRotation(R)) {
      Fail(node, key, "not a rotation matrix; it maps camera 1 to camera 2");
    }
    return R;
  }

  Vector3d Translation(const std::string& key) const {
    const YAML::Node node = Find(key);
    const Matrix m = ReadMatrix(key, node);
    if (m.data.size() != 3 || (m.rows != 1 && m.cols != 1)) {
      Fail(node, key, "not a vector of 3 numbers");
    }
    const Vector3d t(m.data[0], m.data[1], m.data[2]);
    if (t.norm() < kMinBaseline || t.norm() > kMaxBaseline) {
      Fail(node, key, "baseline is not between 0.001 and 10 m; give T in metres");
    }
    return t;
  }

  std::string file_;
  YAML::Node root_;
};

// cv::FileStorage begins with "%YAML:1.0", which is no YAML directive. A comment in its place keeps
// line numbers.
std::string WithoutOpenCvDirective(std::string text) {
  if (text.rfind("%YAML:", 0) == 0) text[0] = '#';
  return text;
}

void AppendMatrix(std::string& out, const char* key, int rows, int cols, const std::vector<double>& data) {
  char number[40];
  out += std::string(key) + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
         "\n   cols: " + std::to_string(cols) + "\n   dt: d\n   data: [ ";
  for (std::size_t i = 0; i < data.size(); ++i) {
    std::snprintf(number, sizeof number, "%.17e", data[i]);
    if (i > 0) out += i % 3 == 0 ? ",\n       " : ", ";
    out += number;
  }
  out += " ]\n";
}

void AppendCamera(std::string& out, const CameraIntrinsics& c, const char* matrix_key, const char* distortion_key) {
  AppendMatrix(out, matrix_key, 3, 3, {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1});
  AppendMatrix(out, distortion_key, 1, 5, {c.k1, c.k2, c.p1, c.p2, c.k3});
}

}  // namespace

Result<StereoCalibration, std::string> ReadCalibration(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  if (!in || !(text << in.rdbuf())) {
    return unexpected(path.string() + ": calibration cannot be read; a data set needs calib.yaml");
  }
  try {
    const YAML::Node root = YAML::Load(WithoutOpenCvDirective(text.str()));
    return CalibrationReader(path.string(), root).Read();
  } catch (const Malformed& e) {
    return unexpected(e.message);
  } catch (const YAML::Exception& e) {
    return unexpected(path.string() + ":" + std::to_string(e.mark.line + 1) + ": not legal YAML: " + e.msg +
                      "; write it with cv::FileStorage");
  }
}

Result<void, std::string> WriteCalibration(const std::filesystem::path& path, const StereoCalibration& calibration) {
  const Pose& T = calibration.T_right_left;
  std::vector<double> R(9);
  for (int i = 0; i < 9; ++i) R[static_cast<std::size_t>(i)] = T.R(i / 3, i % 3);
  std::string out = "%YAML:1.0\n---\n";
  AppendCamera(out, calibration.left, "K1", "D1");
  AppendCamera(out, calibration.right, "K2", "D2");
  AppendMatrix(out, "R", 3, 3, R);
  AppendMatrix(out, "T", 3, 1, {T.t.x(), T.t.y(), T.t.z()});
  out += "image_width: " + std::to_string(calibration.width) + "\n";
  out += "image_height: " + std::to_string(calibration.height) + "\n";
  std::ofstream file(path, std::ios::binary);
  if (!(file << out) || !file.flush()) {
    return unexpected(path.string() + ": cannot be written; check folder, permissions and free space");
  }
  return {};
}

}  // namespace wirepose::dataset
