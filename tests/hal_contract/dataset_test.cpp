#include "hal/dataset/dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "test_data.h"

namespace wirepose::dataset {
namespace {

namespace fs = std::filesystem;
namespace test = hal::test;
using testing::HasSubstr;
using testing::Not;

class DatasetTest : public testing::Test {
 protected:
  void SetUp() override { test::WriteDataset(root_, 2); }

  void Replace(const std::string& file, const std::string& from, const std::string& to) const {
    std::string text = test::ReadText(root_ / file);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    test::WriteText(root_ / file, text.replace(at, from.size(), to));
  }

  // The one-line error of reading the data set.
  [[nodiscard]] std::string Error() const {
    const auto dataset = ReadDataset(root_);
    if (dataset) return "it was read";
    EXPECT_THAT(dataset.error(), Not(HasSubstr("\n")));
    return dataset.error();
  }

  test::TemporaryFolder folder_;
  fs::path root_ = folder_.path() / "set";
};

TEST_F(DatasetTest, WrittenDataReadsBackExactly) {
  const auto dataset = ReadDataset(root_);
  ASSERT_TRUE(dataset) << dataset.error();
  const StereoCalibration expected = test::SmallCalibration();
  EXPECT_EQ(dataset->calibration.left.k1, expected.left.k1);
  EXPECT_EQ(dataset->calibration.left.p2, expected.left.p2);
  EXPECT_EQ(dataset->calibration.right.k3, expected.right.k3);
  EXPECT_EQ(dataset->calibration.T_right_left.R, expected.T_right_left.R);
  EXPECT_EQ(dataset->calibration.T_right_left.t, expected.T_right_left.t);
  ASSERT_EQ(dataset->frames.size(), 4U);
  for (int i = 0; i < 4; ++i) {
    const FrameEntry& frame = dataset->frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(frame.scene_id, 1 + i / 2);
    EXPECT_EQ(frame.im_id, i % 2);
    ASSERT_TRUE(frame.has_truth);
    ASSERT_EQ(frame.gt.size(), 1U);
    EXPECT_EQ(frame.gt[0].obj_id, 3);
    EXPECT_NEAR(frame.gt[0].T_camera_model.t.x(), 0.01 * i, 1e-15);
    EXPECT_NEAR(frame.gt[0].visib_fract, (100 + i) / 200.0, 1e-15);
    const auto left = ReadGrayPng(frame.left_path);
    ASSERT_TRUE(left) << left.error().message;
    EXPECT_EQ(left->pixels, test::Pattern(i, 0).pixels);
  }
}

TEST_F(DatasetTest, OpenCvReadsTheCalibration) {
  cv::FileStorage file((root_ / "calib.yaml").string(), cv::FileStorage::READ);
  cv::Mat K, D, R, T;
  file["K2"] >> K;
  file["D1"] >> D;
  file["R"] >> R;
  file["T"] >> T;
  const StereoCalibration expected = test::SmallCalibration();
  EXPECT_EQ(K.at<double>(1, 2), expected.right.cy);
  EXPECT_EQ(D.at<double>(0, 4), expected.left.k3);
  EXPECT_EQ(R.at<double>(0, 1), expected.T_right_left.R(0, 1));
  EXPECT_EQ(T.at<double>(0, 0), expected.T_right_left.t.x());
  EXPECT_EQ(static_cast<int>(file["image_width"]), test::kWidth);
}

TEST_F(DatasetTest, ReadsWhatOpenCvWrites) {
  const StereoCalibration c = test::SmallCalibration();
  for (const int coefficients : {4, 5, 8, 12, 14}) {
    cv::FileStorage file((root_ / "calib.yaml").string(), cv::FileStorage::WRITE);
    cv::Mat D = cv::Mat::zeros(1, coefficients, CV_64F);
    D.at<double>(0, 3) = 0.001;
    file << "K1" << cv::Mat(cv::Matx33d(c.left.fx, 0, c.left.cx, 0, c.left.fy, c.left.cy, 0, 0, 1));
    file << "D1" << D;
    file << "K2" << cv::Mat(cv::Matx33d(500, 0, 320, 0, 501, 240, 0, 0, 1));
    file << "D2" << D.t();
    file << "R" << cv::Mat(cv::Matx33d::eye()) << "T" << cv::Mat(cv::Vec3d(-0.1, 0, 0));
    file << "image_width" << 640 << "image_height" << 480;
    file.release();
    const auto read = ReadCalibration(root_ / "calib.yaml");
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(read->left.fx, c.left.fx);
    EXPECT_EQ(read->right.p2, 0.001);
    EXPECT_EQ(read->left.k3, 0);
  }
}

TEST_F(DatasetTest, MalformedCalibrationIsNamedByLineAndKey) {
  const std::string good = test::ReadText(root_ / "calib.yaml");
  const auto error = [&](const std::string& from, const std::string& to) {
    test::WriteText(root_ / "calib.yaml", good);
    Replace("calib.yaml", from, to);
    return Error();
  };
  EXPECT_THAT(error("K2:", "Q2:"), HasSubstr("calib.yaml: K2: missing"));
  EXPECT_THAT(error("rows: 3", "rows: 2"), HasSubstr("K1"));
  EXPECT_THAT(error("rows: 3", "rows: -3"), HasSubstr("K1"));
  EXPECT_THAT(error("1.31250000000000000e+02", "oops"), HasSubstr(":7: K1: not a finite number"));
  EXPECT_THAT(error("1.31250000000000000e+02", ".nan"), HasSubstr("not a finite number"));
  EXPECT_THAT(error("1.31250000000000000e+02", "-5"), HasSubstr("focal length is not positive"));
  EXPECT_THAT(error("image_width: 160", "image_width: 0"), HasSubstr("image_width"));
  EXPECT_THAT(error("image_width: 160", "image_width: wide"), HasSubstr("image_width"));
  EXPECT_THAT(error("-1.19999999999999996e-01", "-120"), HasSubstr("give T in metres"));
  EXPECT_THAT(error("R: !!opencv-matrix\n   rows: 3", "R: !!opencv-matrix\n   rows: 1"),
              HasSubstr("R: data does not hold"));
  EXPECT_THAT(error("---", "--- [}"), HasSubstr("not legal YAML"));
  test::WriteText(root_ / "calib.yaml", "just words");
  EXPECT_THAT(Error(), HasSubstr("not a calibration"));
  test::WriteText(root_ / "calib.yaml", "");
  EXPECT_THAT(Error(), HasSubstr("calib.yaml"));
  fs::remove(root_ / "calib.yaml");
  EXPECT_THAT(Error(), HasSubstr("calib.yaml"));
}

TEST_F(DatasetTest, RefusesDistortionThatItCannotModel) {
  Replace("calib.yaml", "cols: 5", "cols: 6");
  Replace("calib.yaml", "1.00000000000000002e-03 ]", "0.001, 0.25 ]");
  EXPECT_THAT(Error(), HasSubstr("D1: coefficient 6 is not zero"));
}

TEST_F(DatasetTest, RefusesAReflectionForR) {
  StereoCalibration mirrored = test::SmallCalibration();
  mirrored.T_right_left.R.col(0) *= -1;
  ASSERT_TRUE(WriteCalibration(root_ / "calib.yaml", mirrored));
  EXPECT_THAT(Error(), HasSubstr("R: not a rotation matrix"));
}

// Whatever a byte of the calibration is replaced by, the answer is a calibration or a one-line
// error.
TEST_F(DatasetTest, DamagedCalibrationNeverCrashes) {
  const std::string good = test::ReadText(root_ / "calib.yaml");
  const std::string bytes = "0-:[]{}!&*#\n \t%\"'\xff,";
  for (std::size_t i = 0; i < good.size(); i += 5) {
    std::string bad = good;
    bad[i] = bytes[i / 5 % bytes.size()];
    test::WriteText(root_ / "calib.yaml", i % 2 == 0 ? bad : good.substr(0, i));
    const auto read = ReadCalibration(root_ / "calib.yaml");
    if (read) continue;
    EXPECT_THAT(read.error(), Not(HasSubstr("\n")));
  }
}

TEST_F(DatasetTest, MalformedTruthIsNamed) {
  const std::string file = "test/000001/scene_gt_cam1.json";
  const std::string good = test::ReadText(root_ / file);
  const auto error = [&](const std::string& from, const std::string& to) {
    test::WriteText(root_ / file, good);
    Replace(file, from, to);
    return Error();
  };
  EXPECT_THAT(error("\"obj_id\": 3", "\"obj_id\": \"three\""),
              HasSubstr("scene_gt_cam1.json: image 0, instance 0: obj_id"));
  EXPECT_THAT(error("\"obj_id\": 3", "\"obj_id\": 2.5"), HasSubstr("obj_id"));
  EXPECT_THAT(error("900.0", "null"), HasSubstr("cam_t_m2c"));
  EXPECT_THAT(error("cam_R_m2c", "cam_R"), HasSubstr("cam_R_m2c"));
  EXPECT_THAT(error("1.0", "5.0"), HasSubstr("not a rotation matrix"));
  EXPECT_THAT(error("\"0\"", "\"zero\""), HasSubstr("key \"zero\""));
  test::WriteText(root_ / file, good.substr(0, good.size() / 2));
  EXPECT_THAT(Error(), HasSubstr("scene_gt_cam1.json: parse error at line"));
  test::WriteText(root_ / file, "[]");
  EXPECT_THAT(Error(), HasSubstr("not an object"));
}

TEST_F(DatasetTest, TruthAndItsInfoMustBelongTogether) {
  test::WriteText(root_ / "test/000001/scene_gt_info_cam1.json", "{\"0\": []}");
  EXPECT_THAT(Error(), HasSubstr("another number of instances"));
}

TEST_F(DatasetTest, TruthIsOptional) {
  for (const char* file : {"scene_gt_cam1.json", "scene_gt_info_cam1.json", "scene_camera_cam1.json"}) {
    fs::remove(root_ / "test/000001" / file);
  }
  fs::remove(root_ / "test/000002/scene_gt_info_cam1.json");
  const auto dataset = ReadDataset(root_);
  ASSERT_TRUE(dataset) << dataset.error();
  ASSERT_EQ(dataset->frames.size(), 4U);
  EXPECT_FALSE(dataset->frames[0].has_truth);
  EXPECT_TRUE(dataset->frames[2].has_truth);
  EXPECT_EQ(dataset->frames[2].gt[0].visib_fract, 1);
}

TEST_F(DatasetTest, ALostImageLeavesItsFrame) {
  fs::remove(root_ / "test/000001/gray_cam1/000001.png");
  fs::remove(root_ / "test/000001/scene_camera_cam1.json");
  const auto dataset = ReadDataset(root_);
  ASSERT_TRUE(dataset);
  ASSERT_EQ(dataset->frames.size(), 4U);
  const auto image = ReadGrayPng(dataset->frames[1].left_path);
  ASSERT_FALSE(image);
  EXPECT_TRUE(image.error().missing);
}

TEST_F(DatasetTest, EmptyDataSetIsNamed) {
  fs::remove_all(root_ / "test/000001");
  fs::remove_all(root_ / "test/000002");
  EXPECT_THAT(Error(), HasSubstr("data set is empty"));
  fs::remove_all(root_ / "test");
  EXPECT_THAT(Error(), HasSubstr("test: no such folder"));
  EXPECT_THAT(ReadDataset(root_ / "nowhere").error(), HasSubstr("no such data set folder"));
}

TEST_F(DatasetTest, WriterRefusesToMixDataSets) {
  const auto writer = DatasetWriter::Create(root_, test::SmallCalibration());
  ASSERT_FALSE(writer);
  EXPECT_THAT(writer.error(), HasSubstr("there is a data set already"));
}

// Every stereo data set of real or photorealistic images at hand is read in full.
TEST(RealData, EveryStereoSetReads) {
  const char* named = std::getenv("WIREPOSE_REAL_DATA");
  const fs::path folder = named != nullptr ? named : WIREPOSE_DEFAULT_REAL_DATA;
  int sets = 0;
  for (const char* name : {"kitchen-sample", "teabox-stereo"}) {
    if (!fs::exists(folder / name)) continue;
    ++sets;
    const auto dataset = ReadDataset(folder / name);
    ASSERT_TRUE(dataset) << dataset.error();
    for (const FrameEntry& frame : dataset->frames) {
      EXPECT_TRUE(frame.has_truth);
      for (const fs::path& path : {frame.left_path, frame.right_path}) {
        const auto image = ReadGrayPng(path);
        ASSERT_TRUE(image) << image.error().message;
        EXPECT_EQ(image->width, dataset->calibration.width);
        EXPECT_EQ(image->height, dataset->calibration.height);
      }
    }
  }
  if (sets == 0) GTEST_SKIP() << "no real data; set WIREPOSE_REAL_DATA to its folder";
}

class PngTest : public testing::Test {
 protected:
  [[nodiscard]] std::string File(const std::string& name) const { return (folder_.path() / name).string(); }
  test::TemporaryFolder folder_;
};

cv::Mat Noise(int type) {
  cv::Mat image(37, 53, type);
  cv::RNG random(3);
  random.fill(image, cv::RNG::UNIFORM, 0, CV_MAT_DEPTH(type) == CV_16U ? 65536 : 256);
  return image;
}

TEST_F(PngTest, ReadsGrayAsOpenCvDoes) {
  const cv::Mat image = Noise(CV_8UC1);
  cv::imwrite(File("gray.png"), image);
  const auto read = ReadGrayPng(File("gray.png"));
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->width, 53);
  ASSERT_EQ(read->height, 37);
  EXPECT_EQ(std::memcmp(read->pixels.data(), image.data, 37 * 53), 0);
}

TEST_F(PngTest, ColourBecomesLuma) {
  for (const int type : {CV_8UC3, CV_8UC4}) {
    const cv::Mat image = Noise(type);
    cv::imwrite(File("colour.png"), image);
    const auto read = ReadGrayPng(File("colour.png"));
    ASSERT_TRUE(read) << read.error().message;
    for (int y = 0; y < 37; ++y) {
      for (int x = 0; x < 53; ++x) {
        const std::uint8_t* bgr = image.ptr(y, x);
        const double luma = 0.114 * bgr[0] + 0.587 * bgr[1] + 0.299 * bgr[2];
        ASSERT_NEAR(read->view()(x, y), luma, 0.51);
      }
    }
  }
}

TEST_F(PngTest, DepthRoundTrip) {
  const cv::Mat image = Noise(CV_16UC1);
  cv::imwrite(File("cv.png"), image);
  const auto read = ReadDepthPng(File("cv.png"));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(std::memcmp(read->pixels.data(), image.data, 2 * 37 * 53), 0);
  ASSERT_TRUE(WriteDepthPng(File("own.png"), read->view()));
  const cv::Mat back = cv::imread(File("own.png"), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::norm(back, image, cv::NORM_INF), 0);
}

TEST_F(PngTest, WritesRowsOfAnyStride) {
  const cv::Mat image = Noise(CV_8UC1);
  ASSERT_TRUE(WriteGrayPng(File("part.png"), {image.data + 5, 20, 30, 53}));
  const cv::Mat back = cv::imread(File("part.png"), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::norm(back, image(cv::Rect(5, 0, 20, 30)), cv::NORM_INF), 0);
}

TEST_F(PngTest, WrongKindsAreRefused) {
  cv::imwrite(File("deep.png"), Noise(CV_16UC1));
  cv::imwrite(File("gray.png"), Noise(CV_8UC1));
  const auto gray = ReadGrayPng(File("deep.png"));
  ASSERT_FALSE(gray);
  EXPECT_FALSE(gray.error().missing);
  EXPECT_THAT(gray.error().message, HasSubstr("16 bits"));
  const auto depth = ReadDepthPng(File("gray.png"));
  ASSERT_FALSE(depth);
  EXPECT_THAT(depth.error().message, HasSubstr("not 16 bit grey"));
  EXPECT_FALSE(ReadGrayPng(folder_.path())) << "a folder";
  EXPECT_FALSE(WriteGrayPng(File("no/such/folder.png"), test::Pattern(0, 0).view()));
}

TEST_F(PngTest, DamagedFilesNeverCrash) {
  cv::imwrite(File("good.png"), Noise(CV_8UC1));
  const std::string good = test::ReadText(File("good.png"));
  int refused = 0;
  for (std::size_t i = 0; i < good.size(); i += 11) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x55);
    test::WriteText(File("bad.png"), bad);
    refused += ReadGrayPng(File("bad.png")) ? 0 : 1;
    test::WriteText(File("bad.png"), good.substr(0, i));
    const auto cut = ReadGrayPng(File("bad.png"));
    // Behind the pixels only the checksum and the end mark are left.
    ASSERT_TRUE(!cut || i + 20 >= good.size()) << "cut at " << i << " of " << good.size();
    if (cut) continue;
    ASSERT_THAT(cut.error().message, Not(HasSubstr("\n")));
  }
  EXPECT_GT(refused, static_cast<int>(good.size() / 11 * 9 / 10));
}

}  // namespace
}  // namespace wirepose::dataset
