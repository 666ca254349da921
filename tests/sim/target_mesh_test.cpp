#include "sim/target_mesh.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

namespace wirepose::sim {
namespace {

namespace fs = std::filesystem;

class TargetMeshTest : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) /
            ("target_mesh_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(root_);
    fs::create_directories(root_ / "models");
  }
  void TearDown() override { fs::remove_all(root_); }

  void Write(const std::string& name, const std::string& text) const { std::ofstream(root_ / "models" / name) << text; }

  fs::path root_;
};

constexpr const char* kTriangleObj = "v 0 0 0\nv 100 0 0\nv 0 200 0\nf 1 2 3\n";

TEST_F(TargetMeshTest, WrittenModelsReadBack) {
  const std::vector<TargetMesh> targets = {{2, "book", {}, MakeBox({0.24F, 0.165F, 0.035F})},
                                           {7, "can", {}, MakeCylinder(0.04F, 0.1F, 8)}};
  ASSERT_TRUE(WriteTargetMeshes(root_, targets));
  const auto read = LoadTargetMeshes(root_ / "models");
  ASSERT_TRUE(read) << read.error();
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ((*read)[0].obj_id, 2);
  EXPECT_EQ((*read)[1].obj_id, 7);
  EXPECT_EQ((*read)[0].mesh.triangles.size(), 12U);
  EXPECT_LT(((*read)[0].mesh.Max() - Vector3(0.12F, 0.0825F, 0.0175F)).norm(), 1e-6F);

  std::ifstream in(root_ / "models" / "models_info.json");
  const auto info = nlohmann::json::parse(in);
  EXPECT_NEAR(info["2"]["diameter"].get<double>(), 293.3428, 1e-3);
  EXPECT_NEAR(info["2"]["min_x"].get<double>(), -120, 1e-3);
  EXPECT_NEAR(info["2"]["size_z"].get<double>(), 35, 1e-3);
  EXPECT_EQ(info["2"]["symmetries_discrete"].size(), 3U);
}

TEST_F(TargetMeshTest, NamesGiveIds) {
  Write("refrigerator.obj", kTriangleObj);
  Write("obj_000009.obj", kTriangleObj);
  Write("zebra.obj", kTriangleObj);
  Write("apple.obj", kTriangleObj);
  Write("notes.txt", "no mesh");
  const auto read = LoadTargetMeshes(root_ / "models");
  ASSERT_TRUE(read) << read.error();
  std::vector<std::pair<int, std::string>> ids;
  for (const TargetMesh& target : *read) ids.emplace_back(target.obj_id, target.name);
  EXPECT_EQ(ids, (std::vector<std::pair<int, std::string>>{
                     {4, "refrigerator"}, {9, "obj_000009"}, {10, "apple"}, {11, "zebra"}}));
}

TEST_F(TargetMeshTest, RefusesWhatIsNoMesh) {
  EXPECT_FALSE(LoadTargetMeshes(root_ / "nowhere"));
  EXPECT_FALSE(LoadTargetMeshes(root_ / "models")) << "empty folder";
  Write("broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
  const auto read = LoadTargetMeshes(root_ / "models");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().find("broken.ply"), std::string::npos);
  EXPECT_EQ(read.error().find('\n'), std::string::npos);
}

TEST_F(TargetMeshTest, RefusesTwoFilesForOneId) {
  Write("book.obj", kTriangleObj);
  Write("obj_000002.obj", kTriangleObj);
  const auto read = LoadTargetMeshes(root_ / "models");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().find("object id 2"), std::string::npos);
}

TEST(BoxSymmetries, OfKnownShapes) {
  EXPECT_EQ(BoxSymmetries(MakeBox({0.3F, 0.2F, 0.15F})).size(), 3U);
  EXPECT_EQ(BoxSymmetries(MakeBox({0.3F, 0.2F, 0.2F})).size(), 7U);
  EXPECT_EQ(BoxSymmetries(MakeBox({0.2F, 0.2F, 0.2F})).size(), 23U);
  Mesh lopsided = MakeBox({0.3F, 0.2F, 0.15F});
  lopsided.vertices[7].x() *= 0.5F;
  EXPECT_TRUE(BoxSymmetries(lopsided).empty());
}

TEST(BoxSymmetries, TurnAboutTheMiddleOfTheBox) {
  Mesh box = MakeBox({0.3F, 0.2F, 0.15F});
  for (Vector3& vertex : box.vertices) vertex += Vector3(1, 2, 3);
  for (const Pose& symmetry : BoxSymmetries(box)) {
    EXPECT_LT((symmetry * Vector3d(1, 2, 3) - Vector3d(1, 2, 3)).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace wirepose::sim
