// Rivals of a box's ends and pose, on edge maps in which the edges of a box of exactly known size and pose are drawn.
#include "stages/rival_evidence.h"

#include <gtest/gtest.h>

#include "model_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;

// Marks the cells within the map's radius of the points of an edge, as ridge pixels would.
void Draw(const Vector2& a, const Vector2& b, EdgeMap& map) {
  const Vector2 delta = b - a;
  const int direction = EdgeMap::Direction(delta.x(), delta.y());
  const int steps = static_cast<int>(2 * delta.norm()) + 1;
  std::uint16_t bits = 0;
  for (int d = direction - 1; d <= direction + 1; ++d)
    bits |= static_cast<std::uint16_t>(1U << ((d + EdgeMap::kDirections) % EdgeMap::kDirections));
  for (int k = 0; k <= steps; ++k) {
    const Vector2 p = a + static_cast<float>(k) / static_cast<float>(steps) * delta;
    if (!map.Contains(p.x(), p.y())) continue;
    const int i = static_cast<int>(0.5F * p.x() + 0.5F), j = static_cast<int>(0.5F * p.y() + 0.5F);
    for (const auto& [x, y] : {std::pair{i, j}, {i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}})
      map.directions[static_cast<std::size_t>(y * EdgeMap::kStride + x)] |= bits;
  }
}

class RivalEvidenceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Clear(*left_, camera_.width);
    Clear(*right_, camera_.width);
  }

  static void Clear(EdgeMap& map, int width) {
    map.width = width;
    map.height = width > 0 ? 480 : 0;
    map.directions.fill(0);
  }

  // A view of the box with three faces in view, none of them edge on.
  void Look(Random& random) {
    do {
      T_.R = testing::AnyRotation(random);
    } while (T_.R.row(2).cwiseAbs().minCoeff() < 0.3);
    T_.t = Vector3d(0, 0, random.Uniform(0.8, 1.2)) - T_.R * model_->centre.cast<double>();
    SampleVisibleEdges({.step_px = 4}, camera_, *model_, T_, *front_, *samples_);
  }

  // The edges that are seen, those around `face` moved by `move` m along its normal.
  void DrawBox(std::size_t face, float move, bool left, bool right) { DrawBoxAt(T_, face, move, left, right); }

  void DrawBoxAt(const Pose& T, std::size_t face, float move, bool left, bool right) {
    const EdgeBits seen = EdgesOf(*samples_);
    const ModelFace& end = model_->view.faces[face];
    const Vector3 normal(end.normal[0], end.normal[1], end.normal[2]);
    const auto moved = [&](const Vector3& corner) -> Vector3 {
      const bool at_end = std::abs(corner.dot(normal) - end.offset_m) < 1e-4F;
      return at_end ? Vector3(corner + move * normal) : corner;
    };
    for (std::size_t e = NextEdge(seen, 0); e < model_->edges.size(); e = NextEdge(seen, e + 1)) {
      const Vector3d a = camera_.Project(T * moved(model_->edges[e].a).cast<double>());
      const Vector3d b = camera_.Project(T * moved(model_->edges[e].b).cast<double>());
      if (left) Draw(a.head<2>().cast<float>(), b.head<2>().cast<float>(), *left_);
      const Vector3d shift_a(a.z(), 0, 0), shift_b(b.z(), 0, 0);
      if (right) Draw((a - shift_a).head<2>().cast<float>(), (b - shift_b).head<2>().cast<float>(), *right_);
    }
  }

  // How far the seen edges of an end move across themselves in the image, at least, px: what moves along itself is seen
  // where it was. 0 when less than 60 px of them are seen.
  [[nodiscard]] float MovePx(std::size_t face, float move) const {
    const ModelFace& end = model_->view.faces[face];
    const Vector3 normal(end.normal[0], end.normal[1], end.normal[2]);
    float least = 1e9F, length = 0;
    for (const EdgeSample& s : *samples_) {
      const auto& faces = model_->view.edges[s.edge].face;
      if (faces[0] != face && faces[1] != face) continue;
      const Vector3d p = camera_.Project(T_ * Vector3(s.point + move * normal).cast<double>());
      least =
          std::min(least, std::abs((p.head<2>().cast<float>() - s.left).dot(Vector2(-s.tangent.y(), s.tangent.x()))));
      length += s.weight_px;
    }
    return length < 60 ? 0 : least;
  }

  [[nodiscard]] RivalEvidence Gather() const {
    RivalEvidence out;
    GatherRivalEvidence({}, camera_, *left_, *right_, *model_, T_, *samples_, *scratch_, out);
    return out;
  }

  RectifiedCamera camera_ = testing::TestCamera();
  testing::TestModel model_ = testing::Load("parcel_box");
  Pose T_;
  std::unique_ptr<FrontTriangles> front_ = std::make_unique<FrontTriangles>();
  std::unique_ptr<EdgeSamples> samples_ = std::make_unique<EdgeSamples>();
  std::unique_ptr<RivalScratch> scratch_ = std::make_unique<RivalScratch>();
  std::unique_ptr<EdgeMap> left_ = std::make_unique<EdgeMap>(), right_ = std::make_unique<EdgeMap>();
};

TEST_F(RivalEvidenceTest, TheRightSizeAndPoseHaveNoRival) {
  Random random(1);
  for (int k = 0; k < Cases(300); ++k) {
    SetUp();
    Look(random);
    DrawBox(0, 0, true, true);
    const RivalEvidence e = Gather();
    EXPECT_LT(std::max({e.inward, e.outward, e.left}), 0.15F) << k;
    EXPECT_LT(std::max(e.moved, e.turned), 0.05F) << k;
    EXPECT_GT(e.end_peak, 0.3F) << k;
    EXPECT_GT(std::min(e.moved_peak, e.turned_peak), 0.4F) << k;
  }
}

TEST_F(RivalEvidenceTest, AnEndFartherOutOrInIsFound) {
  Random random(2);
  int tried = 0;
  float sum = 0;
  for (int k = 0; k < Cases(600); ++k) {
    SetUp();
    Look(random);
    const std::size_t face = model_->feet[static_cast<std::size_t>(k) % model_->feet.size()].face;
    const float move = (k % 2 == 0 ? 1.0F : -1.0F) * static_cast<float>(random.Uniform(0.04, 0.09));
    if (MovePx(face, move) < 8) continue;
    ++tried;
    DrawBox(face, move, true, true);
    const RivalEvidence e = Gather();
    const float gain = move > 0 ? e.outward : e.inward;
    sum += gain;
    EXPECT_GT(gain, 0.5F) << k;
    EXPECT_NEAR(e.rival - e.own, std::max(e.inward, e.outward), 1e-5F) << k;
    EXPECT_GT(e.left, 0.5F) << k;
    EXPECT_LT(e.end_peak, 0.3F) << k;
  }
  ASSERT_GT(tried, Cases(600) / 5);
  EXPECT_GT(sum / static_cast<float>(tried), 0.8F);
}

// What only the left image shows at a place lies at another depth.
TEST_F(RivalEvidenceTest, BothImagesMustShowIt) {
  Random random(3);
  int tried = 0;
  for (int k = 0; k < Cases(300); ++k) {
    SetUp();
    Look(random);
    const std::size_t face = model_->feet[static_cast<std::size_t>(k) % model_->feet.size()].face;
    if (MovePx(face, 0.06F) < 8) continue;
    ++tried;
    DrawBox(face, 0.06F, true, false);
    const RivalEvidence one = Gather();
    EXPECT_LT(one.outward, 0.15F) << k;
    EXPECT_GT(one.left, 0.5F) << k;
    Clear(*right_, 0);  // no second image: the left one says it all
    EXPECT_GT(Gather().outward, 0.5F) << k;
  }
  EXPECT_GT(tried, Cases(300) / 5);
}

// Along and about the model's axes, by multiples of what the image tells apart.
TEST_F(RivalEvidenceTest, TheObjectElsewhereOrTurnedIsFound) {
  Random random(4);
  for (int k = 0; k < Cases(300); ++k) {
    SetUp();
    Look(random);
    const Vector3d axis = Vector3d::Unit(k % 3);
    const double side = k % 2 == 0 ? 1 : -1;
    Pose moved = T_;
    moved.t += side * random.Uniform(0.05, 0.08) * (T_.R * axis);
    DrawBoxAt(moved, 0, 0, true, true);
    const RivalEvidence by_way = Gather();
    SetUp();
    const Vector3d centre = T_ * model_->centre.cast<double>();
    Pose turned = T_;
    turned.R = T_.R * ExpSo3(side * 0.2 * axis);
    turned.t = centre - turned.R * model_->centre.cast<double>();
    DrawBoxAt(turned, 0, 0, true, true);
    const RivalEvidence by_angle = Gather();
    EXPECT_GT(by_way.moved, 0.25F) << k;
    EXPECT_LT(by_way.moved_peak, 0.3F) << k;
    EXPECT_GT(by_angle.turned, 0.25F) << k;
    EXPECT_LT(by_angle.turned_peak, 0.3F) << k;
  }
}

TEST_F(RivalEvidenceTest, NothingSeenSaysNothing) {
  Random random(5);
  Look(random);
  samples_->clear();
  const RivalEvidence e = Gather();
  EXPECT_EQ(e.inward, 0);
  EXPECT_EQ(e.outward, 0);
  EXPECT_EQ(e.left, 0);
  EXPECT_EQ(e.moved, 0);
  EXPECT_EQ(e.turned, 0);
  EXPECT_EQ(std::min({e.end_peak, e.moved_peak, e.turned_peak}), 1);
}

}  // namespace
}  // namespace wirepose
