// Rendering to disk: complete, resumable, independent of the number of threads.
#include "sim/suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "hal/dataset/dataset.h"
#include "test_scenes.h"

namespace wirepose::sim {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SuiteTest : public testing::Test {
 protected:
  SuiteTest() : folder_(fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    spec_.scenes = 2;
    spec_.frames = 2;
    spec_.samples = 4;
    spec_.camera.calibration = test::SmallCalibration(0.125);
  }
  ~SuiteTest() override { fs::remove_all(folder_); }

  RenderProgress Render(const std::string& name, int threads) {
    RenderProgress last;
    const auto done = RenderDatasets({{spec_, folder_ / name}}, test::BoxAndBook(), threads,
                                     [&](const RenderProgress& p) { last = p; });
    EXPECT_TRUE(done) << done.error();
    return last;
  }

  // All files below a folder with their bytes.
  static std::map<std::string, std::string> Bytes(const fs::path& root) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      if (!entry.is_regular_file()) continue;
      std::ostringstream text;
      text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
      files[fs::relative(entry.path(), root).string()] = text.str();
    }
    return files;
  }

  fs::path folder_;
  ScenarioSpec spec_;
};

TEST_F(SuiteTest, SameBytesOnAnyNumberOfThreads) {
  EXPECT_EQ(Render("one", 1).done, 4);
  EXPECT_EQ(Render("three", 3).done, 4);
  const auto one = Bytes(folder_ / "one");
  EXPECT_EQ(one, Bytes(folder_ / "three"));
  EXPECT_TRUE(one.contains("contact_sheet.png"));
  const auto set = dataset::ReadDataset(folder_ / "one");
  ASSERT_TRUE(set) << set.error();
  EXPECT_EQ(set->frames.size(), 4U);
  EXPECT_TRUE(set->frames[3].has_truth);
}

TEST_F(SuiteTest, GoesOnWhereItStopped) {
  Render("set", 2);
  const auto complete = Bytes(folder_ / "set");
  fs::remove(folder_ / "set" / "test" / "000002" / "scene_gt_info_cam1.json");  // as if it had been stopped there
  const RenderProgress second = Render("set", 2);
  EXPECT_EQ(second.reused, 2);
  EXPECT_EQ(second.done, 4);
  EXPECT_EQ(Bytes(folder_ / "set"), complete);
  spec_.seed = 99;
  EXPECT_EQ(Render("set", 2).reused, 0) << "another scenario is rendered anew";
  EXPECT_NE(Bytes(folder_ / "set"), complete);
}

TEST_F(SuiteTest, LeavesForeignFoldersAlone) {
  fs::create_directories(folder_ / "photos");
  std::ofstream(folder_ / "photos" / "holiday.txt") << "sun";
  const auto done = RenderDatasets({{spec_, folder_ / "photos"}}, test::BoxAndBook(), 1, {});
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error(), HasSubstr("photos"));
  EXPECT_TRUE(fs::exists(folder_ / "photos" / "holiday.txt"));
}

TEST_F(SuiteTest, ContentHashKnowsWhatMatters) {
  const std::string hash = ContentHash(spec_, test::BoxAndBook());
  EXPECT_EQ(hash, ContentHash(spec_, test::BoxAndBook()));
  std::vector<TargetMesh> other = test::BoxAndBook();
  other[1].mesh.vertices[3].x() += 1e-4F;
  EXPECT_NE(hash, ContentHash(spec_, other));
  ScenarioSpec changed = spec_;
  changed.source = "clutter: { count: 3 }";
  EXPECT_NE(hash, ContentHash(changed, test::BoxAndBook()));
  changed = spec_;
  changed.camera.calibration.right.k1 += 1e-6;
  EXPECT_NE(hash, ContentHash(changed, test::BoxAndBook()));
}

}  // namespace
}  // namespace wirepose::sim
