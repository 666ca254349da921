// Data sets of one camera with depth: what is read, and what is said of bad ones.
#include "hal/dataset/depth_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "test_data.h"

namespace wirepose::dataset {
namespace {

namespace fs = std::filesystem;
namespace test = hal::test;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kCamera =
    R"({"3": {"cam_K": [131.5, 0, 79.5, 0, 132, 60.25, 0, 0, 1], "depth_scale": 0.25},
        "7": {"cam_K": [131.5, 0, 79.5, 0, 132, 60.25, 0, 0, 1]}})";
constexpr const char* kTruth =
    R"({"3": [{"obj_id": 4, "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [10, -20, 900]}]})";

class DepthDatasetTest : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* folder : {"gray", "depth"}) fs::create_directories(scene_ / folder);
    const std::vector<std::uint16_t> depth(static_cast<std::size_t>(test::kWidth) * test::kHeight, 3600);
    for (const char* name : {"000003.png", "000007.png"}) {
      test::OrThrow(WriteGrayPng(scene_ / "gray" / name, test::Pattern(1, 0).view()));
      test::OrThrow(WriteDepthPng(scene_ / "depth" / name, {depth.data(), test::kWidth, test::kHeight, test::kWidth}));
    }
    test::WriteText(scene_ / "scene_camera.json", kCamera);
    test::WriteText(scene_ / "scene_gt.json", kTruth);
  }

  // The one-line error of reading the set with `from` replaced by `to` in its camera file.
  [[nodiscard]] std::string ErrorWith(const std::string& from, const std::string& to) const {
    std::string text = kCamera;
    const std::size_t at = text.rfind(from);
    EXPECT_NE(at, std::string::npos) << from;
    test::WriteText(scene_ / "scene_camera.json", text.replace(at, from.size(), to));
    return Error();
  }
  [[nodiscard]] std::string Error() const {
    const auto set = ReadDepthDataset(root_);
    if (set) return "it was read";
    EXPECT_THAT(set.error(), Not(HasSubstr("\n")));
    return set.error();
  }

  test::TemporaryFolder folder_;
  fs::path root_ = folder_.path() / "set";
  fs::path scene_ = root_ / "test" / "000002";
};

TEST_F(DepthDatasetTest, ReadsCameraFramesAndTruth) {
  EXPECT_TRUE(IsDepthDataset(root_));
  const auto set = ReadDepthDataset(root_);
  ASSERT_TRUE(set) << set.error();
  ASSERT_TRUE(set->depth_camera);
  EXPECT_EQ(set->depth_camera->camera.fx, 131.5);
  EXPECT_EQ(set->depth_camera->camera.fy, 132);
  EXPECT_EQ(set->depth_camera->camera.cx, 79.5);
  EXPECT_EQ(set->depth_camera->camera.cy, 60.25);
  EXPECT_EQ(set->depth_camera->width, test::kWidth);
  EXPECT_EQ(set->depth_camera->height, test::kHeight);
  ASSERT_EQ(set->frames.size(), 2U);
  const FrameEntry& first = set->frames[0];
  EXPECT_EQ(first.scene_id, 2);
  EXPECT_EQ(first.im_id, 3);
  EXPECT_EQ(first.left_path, scene_ / "gray/000003.png");
  EXPECT_EQ(first.depth_path, scene_ / "depth/000003.png");
  EXPECT_TRUE(first.right_path.empty());
  EXPECT_NEAR(first.depth_unit_m, 0.00025, 1e-12);
  ASSERT_EQ(first.gt.size(), 1U);
  EXPECT_EQ(first.gt[0].obj_id, 4);
  EXPECT_EQ(first.gt[0].T_camera_model.t, Vector3d(0.01, -0.02, 0.9));
  EXPECT_EQ(set->frames[1].depth_unit_m, 0.001) << "millimetres unless said otherwise";
  EXPECT_FALSE(set->frames[1].has_truth);
}

TEST_F(DepthDatasetTest, ColourIsPreferredAndALostImageIsListed) {
  fs::rename(scene_ / "gray", scene_ / "rgb");
  fs::remove(scene_ / "rgb" / "000003.png");
  const auto set = ReadDepthDataset(root_);
  ASSERT_TRUE(set) << set.error();
  EXPECT_EQ(set->frames.size(), 2U);
  EXPECT_EQ(set->frames[1].left_path, scene_ / "rgb/000007.png");
}

TEST_F(DepthDatasetTest, AStereoReaderRefusesItWithTheReason) {
  const auto set = ReadDataset(root_);
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error(), HasSubstr("one camera with depth"));
  EXPECT_THAT(set.error(), HasSubstr("wirepose eval"));
}

TEST_F(DepthDatasetTest, StereoSetsAreNoneOfThese) {
  test::WriteDataset(folder_.path() / "stereo", 1);
  EXPECT_FALSE(IsDepthDataset(folder_.path() / "stereo"));
  EXPECT_FALSE(IsDepthDataset(folder_.path() / "nowhere"));
  EXPECT_FALSE(IsDepthDataset(folder_.path()));
}

TEST_F(DepthDatasetTest, BadFilesAreNamed) {
  EXPECT_THAT(ErrorWith("131.5", "140"), HasSubstr("image 7: cam_K differs from that of scene 2 image 3"));
  EXPECT_THAT(ErrorWith("131.5", "-1"), HasSubstr("scene_camera.json: image 7: cam_K is not of the form"));
  EXPECT_THAT(ErrorWith("132", "\"wide\""), HasSubstr("cam_K is missing or not a list of 9 numbers"));
  EXPECT_THAT(ErrorWith("_scale\": 0.25", "_scale\": 0"), HasSubstr("image 3: depth_scale is not above 0"));
  EXPECT_THAT(ErrorWith("_scale\": 0.25", "_scale\": \"mm\""), HasSubstr("depth_scale is missing or not a number"));
  EXPECT_THAT(ErrorWith("}}", "}"), HasSubstr("scene_camera.json"));
  test::WriteText(scene_ / "scene_camera.json", "{}");
  EXPECT_THAT(Error(), HasSubstr("data set is empty"));
  test::WriteText(scene_ / "scene_camera.json", kCamera);
  EXPECT_EQ(Error(), "it was read");
  test::WriteText(scene_ / "gray" / "000003.png", "no picture");
  EXPECT_THAT(Error(), HasSubstr("000003.png"));
  fs::remove_all(scene_ / "gray");
  EXPECT_THAT(Error(), HasSubstr("is missing, and so is every other image"));
}

TEST(RealDepthDataset, PictureCube) {
  const char* folder = std::getenv("WIREPOSE_REAL_DATA");
  const fs::path root = fs::path(folder != nullptr ? folder : WIREPOSE_DEFAULT_REAL_DATA) / "picture-cube-rgbd";
  if (!fs::exists(root)) GTEST_SKIP() << root << " is absent; set WIREPOSE_REAL_DATA to the folder of real data";
  const auto set = ReadDepthDataset(root);
  ASSERT_TRUE(set) << set.error();
  EXPECT_EQ(set->frames.size(), 7U);
  EXPECT_EQ(set->depth_camera->width, 640);
  for (const FrameEntry& frame : set->frames) {
    EXPECT_EQ(frame.gt.size(), 1U);
    const auto depth = ReadDepthPng(frame.depth_path);
    ASSERT_TRUE(depth) << depth.error().message;
    EXPECT_EQ(depth->height, 480);
  }
}

}  // namespace
}  // namespace wirepose::dataset
