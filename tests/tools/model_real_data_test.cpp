// The meshes that come with recorded data. Their folder: WIREPOSE_REAL_DATA, else ../shared/data
// beside the sources.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/model/model_consistency.h"
#include "tools/model_compiler/model_compiler.h"

namespace wirepose {
namespace {

namespace fs = std::filesystem;

fs::path DataFolder() {
  const char* folder = std::getenv("WIREPOSE_REAL_DATA");
  return folder != nullptr ? fs::path(folder) : fs::path(WIREPOSE_DEFAULT_REAL_DATA);
}

struct Expected {
  const char* data_set;
  int id;
  std::size_t edges;  // of a cuboid; 0: more than that
  std::size_t symmetries;
};

class RealMesh : public ::testing::TestWithParam<Expected> {};

TEST_P(RealMesh, CompilesAndAgreesWithModelsInfo) {
  const Expected& expected = GetParam();
  const fs::path folder = DataFolder() / expected.data_set / "models";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent; set WIREPOSE_REAL_DATA to the folder of real data";
  const auto model = tools::CompileModel(folder / ("obj_00000" + std::to_string(expected.id) + ".ply"), {});
  ASSERT_TRUE(model.has_value()) << model.error();
  const ModelView m = model->View();
  EXPECT_EQ(testing::FindInconsistency(m), nullptr);
  EXPECT_EQ(m.symmetries.size(), expected.symmetries);
  if (expected.edges > 0) {
    EXPECT_EQ(m.edges.size(), expected.edges);
  } else {
    EXPECT_GT(m.edges.size(), 100U);
    EXPECT_GT(m.line_sets.size(), 60U);
  }
  std::ifstream in(folder / "models_info.json");
  const auto info = nlohmann::json::parse(in).at(std::to_string(expected.id));
  EXPECT_NEAR(static_cast<double>(m.diameter_m) * 1e3, info.at("diameter").get<double>(), 1e-2);
  EXPECT_NEAR(static_cast<double>(m.box_min_m.y()) * 1e3, info.at("min_y").get<double>(), 1e-3);
  const std::size_t listed = info.contains("symmetries_discrete") ? info.at("symmetries_discrete").size() : 0;
  EXPECT_EQ(m.symmetries.size(), listed);
}

INSTANTIATE_TEST_SUITE_P(All, RealMesh,
                         ::testing::Values(Expected{"teabox-stereo", 1, 12, 3},
                                           Expected{"picture-cube-rgbd", 1, 12, 23},
                                           Expected{"kitchen-sample", 1, 12, 3}, Expected{"kitchen-sample", 2, 12, 3},
                                           Expected{"kitchen-sample", 3, 0, 0}, Expected{"kitchen-sample", 4, 0, 0}),
                         [](const auto& test_case) {
                           std::string name = test_case.param.data_set;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name + "_" + std::to_string(test_case.param.id);
                         });

}  // namespace
}  // namespace wirepose
