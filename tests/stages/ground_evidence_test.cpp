// Objects on planes whose disparity is computed exactly, and the points that are looked at against a second way to say
// where they lie.
#include "stages/ground_evidence.h"

#include <gtest/gtest.h>

#include <functional>

#include "model_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;

class GroundEvidenceTest : public ::testing::Test {
 protected:
  // The object stands on its face `foot`, the camera looks down on it at an angle.
  void Stand(const testing::TestModel& model, std::size_t foot, Random& random, double size_px = 200) {
    const ModelFace& face = model->view.faces[model->feet[foot].face];
    const Vector3d down = Vector3(face.normal[0], face.normal[1], face.normal[2]).cast<double>();
    do {
      T_ = testing::AnyView(random, *model, camera_, size_px);
      normal_ = T_.R * down;
    } while (normal_.z() < 0.35 || normal_.z() > 0.85);
    offset_ = normal_.dot(T_.t) + static_cast<double>(face.offset_m);
    RenderSurface(camera_, *model, T_, *surface_);
  }

  // A plane `below` the object's foot, m, except where `hidden` puts another disparity.
  void SeePlane(double below, const std::function<double(int, int, double)>& change = {}) {
    scene_->width = camera_.width / 2;
    scene_->height = camera_.height / 2;
    for (int j = 0; j < scene_->height; ++j) {
      for (int i = 0; i < scene_->width; ++i) {
        const Vector3d ray((2 * i + 0.5 - camera_.cx) / camera_.f, (2 * j + 0.5 - camera_.cy) / camera_.f, 1);
        const double inverse = normal_.dot(ray) / (offset_ + below);
        double d = inverse > 0 ? camera_.f * camera_.baseline * inverse : 0;
        if (change) d = change(i, j, d);
        scene_->disparity[static_cast<std::size_t>(j * DisparityMap::kMaxWidth + i)] =
            static_cast<std::uint16_t>(d * static_cast<double>(DisparityMap::kOne) + 0.5);
      }
    }
  }

  [[nodiscard]] GroundEvidence Gather(const testing::TestModel& model) const {
    GroundEvidence out;
    GatherGroundEvidence({}, camera_, *scene_, *model, T_, *surface_, out);
    return out;
  }

  RectifiedCamera camera_ = testing::TestCamera();
  testing::TestModel box_ = testing::Load("parcel_box");
  Pose T_;
  Vector3d normal_;    // of the plane, away from the object, camera frame
  double offset_ = 0;  // of the plane from the camera, m
  std::unique_ptr<SurfaceMap> surface_ = std::make_unique<SurfaceMap>();
  std::unique_ptr<DisparityMap> scene_ = std::make_unique<DisparityMap>();
};

TEST_F(GroundEvidenceTest, WhatStandsOnAPlaneStandsWhicheverFaceItIs) {
  Random random(1);
  for (int k = 0; k < Cases(60); ++k) {
    Stand(box_, static_cast<std::size_t>(k) % box_->feet.size(), random);
    SeePlane(0);
    const GroundEvidence e = Gather(box_);
    EXPECT_GT(e.stands, 0.7F) << k;
    EXPECT_EQ(e.hangs, 0) << k;
    EXPECT_LT(e.gap, 0.2F) << k;
  }
}

TEST_F(GroundEvidenceTest, WhatHangsInTheAirDoesNot) {
  Random random(2);
  for (int k = 0; k < Cases(60); ++k) {
    Stand(box_, static_cast<std::size_t>(k) % box_->feet.size(), random);
    SeePlane(1.0);
    const GroundEvidence e = Gather(box_);
    EXPECT_LT(e.stands, 0.35F) << k;  // another face may come near the plane somewhere
    EXPECT_GT(e.hangs, 0.4F) << k;
  }
}

// The nearer the plane, the sooner it is told from the one below the foot.
TEST_F(GroundEvidenceTest, TheGapGrowsWithTheDistanceFromThePlane) {
  Random random(3);
  int grew = 0;
  constexpr int kCases = 40;
  for (int k = 0; k < kCases; ++k) {
    Stand(box_, static_cast<std::size_t>(k) % box_->feet.size(), random);
    SeePlane(0);
    const float on = Gather(box_).gap;
    SeePlane(0.02);
    const GroundEvidence above = Gather(box_);
    grew += above.gap > on + 0.1F || above.stands < 0.5F ? 1 : 0;
  }
  EXPECT_GE(grew, kCases * 9 / 10);
}

TEST_F(GroundEvidenceTest, WhatIsHiddenBySomethingNearerIsSunk) {
  Random random(4);
  Stand(box_, 0, random);
  SeePlane(0, [](int, int, double d) { return d + 30; });
  const GroundEvidence e = Gather(box_);
  EXPECT_EQ(e.stands, 0);
  EXPECT_EQ(e.hangs, 0);
}

TEST_F(GroundEvidenceTest, NothingKnownSaysNothing) {
  Random random(5);
  Stand(box_, 0, random);
  SeePlane(0, [](int, int, double) { return 0.0; });
  const GroundEvidence e = Gather(box_);
  EXPECT_EQ(e.stands, 0);
  EXPECT_EQ(e.hangs, 0);
  EXPECT_EQ(e.sunk, 0);
  EXPECT_EQ(e.gap, 0.5F);
}

// Only what the scene shows beside the silhouette counts, not the object itself.
TEST_F(GroundEvidenceTest, TheObjectItselfHasNoVote) {
  Random random(6);
  for (int k = 0; k < Cases(20); ++k) {
    Stand(box_, 0, random);
    SeePlane(0);
    const GroundEvidence before = Gather(box_);
    SeePlane(0, [&](int i, int j, double d) { return surface_->AtPixel(2 * i, 2 * j) > 0 ? 100.0 : d; });
    const GroundEvidence after = Gather(box_);
    EXPECT_EQ(after.stands, before.stands);
    EXPECT_EQ(after.gap, before.gap);
  }
}

TEST(Feet, AreTheFacesThatTheWholeObjectLiesBehind) {
  EXPECT_EQ(testing::Load("parcel_box")->feet.size(), 6u);
  for (const char* name : {"parcel_box", "book", "juice_dispenser", "refrigerator"}) {
    const testing::TestModel model = testing::Load(name);
    ASSERT_FALSE(model->feet.empty()) << name;
    float area = 1e9F;
    for (const PreparedFoot& foot : model->feet) {
      const ModelFace& face = model->view.faces[foot.face];
      const Vector3 normal(face.normal[0], face.normal[1], face.normal[2]);
      EXPECT_LE(face.area_m2, area);
      area = face.area_m2;
      EXPECT_NEAR(normal.dot(foot.centre), face.offset_m, 1e-3);
      for (std::size_t v = 0; v < model->view.vertices.size(); ++v)
        EXPECT_LT(normal.dot(model->view.VertexPosition(v)), face.offset_m + 0.004F) << name;
    }
  }
  // The upper part of two stands in the way of the lower part's top.
  const testing::TestModel two = testing::Compile(testing::TwoPartMesh());
  for (const PreparedFoot& foot : two->feet) {
    const ModelFace& face = two->view.faces[foot.face];
    EXPECT_FALSE(face.normal[2] > 0.9F && face.offset_m < 0.05F);
  }
}

}  // namespace
}  // namespace wirepose
