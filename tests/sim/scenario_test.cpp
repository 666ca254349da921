#include "sim/scenario.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/placement.h"
#include "test_scenes.h"

namespace wirepose::sim {
namespace {

using Eigen::Vector2d;

Footprint AnyFootprint(Random& random) {
  return {{random.Uniform(-1, 1), random.Uniform(-1, 1)},
          {random.Uniform(0.05, 0.6), random.Uniform(0.05, 0.6)},
          random.Uniform(-4, 4)};
}

bool Contains(const Footprint& f, const Vector2d& p) {
  const Vector2d local = Eigen::Rotation2Dd(-f.yaw_rad) * (p - f.centre);
  return std::abs(local.x()) <= f.half.x() && std::abs(local.y()) <= f.half.y();
}

// A grid of points in one rectangle, asked whether they are in the other.
bool OverlapByPoints(const Footprint& a, const Footprint& b) {
  constexpr int kSteps = 40;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Vector2d local((2.0 * i / kSteps - 1) * a.half.x(), (2.0 * j / kSteps - 1) * a.half.y());
      if (Contains(b, a.centre + Eigen::Rotation2Dd(a.yaw_rad) * local)) return true;
    }
  }
  return false;
}

TEST(Placement, OverlapAgreesWithPoints) {
  Random random(41);
  int overlaps = 0;
  for (int i = 0; i < 2000; ++i) {
    const Footprint a = AnyFootprint(random), b = AnyFootprint(random);
    const bool overlap = OverlapByPoints(a, b) || OverlapByPoints(b, a);
    overlaps += overlap ? 1 : 0;
    if (overlap) {
      EXPECT_TRUE(Overlap(a, b, 0));
    } else {
      EXPECT_FALSE(Overlap(a, b, -0.05)) << "rectangles that sink 5 cm into each other";
    }
    EXPECT_EQ(Overlap(a, b, 0), Overlap(b, a, 0));
  }
  EXPECT_GT(overlaps, 300);
  EXPECT_LT(overlaps, 1700);
}

TEST(Placement, CuboidsRestOnEveryBroadSide) {
  const std::vector<RestingPose> box = RestingPoses(MakeBox({0.3F, 0.2F, 0.15F}));
  EXPECT_EQ(box.size(), 3U);
  // On its narrowest side a book falls over.
  EXPECT_EQ(RestingPoses(MakeBox({0.24F, 0.165F, 0.035F})).size(), 2U);
  for (const RestingPose& rest : box) {
    double lowest = 1, highest = -1;
    for (const Vector3& vertex : MakeBox({0.3F, 0.2F, 0.15F}).vertices) {
      const Vector3d p = rest.T_table_object * vertex.cast<double>();
      lowest = std::min(lowest, p.z());
      highest = std::max(highest, p.z());
      EXPECT_LE(std::abs(p.x()), rest.half.x() + 1e-9);
      EXPECT_LE(std::abs(p.y()), rest.half.y() + 1e-9);
    }
    EXPECT_NEAR(lowest, 0, 1e-9);
    EXPECT_NEAR(highest, rest.height, 1e-9);
    EXPECT_NEAR(rest.T_table_object.R.determinant(), 1, 1e-12);
  }
}

TEST(Placement, OtherThingsStandUpright) {
  Mesh wedge = MakeBox({0.2F, 0.1F, 0.3F});
  wedge.vertices[7] *= 0.5F;
  const std::vector<RestingPose> rests = RestingPoses(wedge);
  ASSERT_EQ(rests.size(), 1U);
  EXPECT_TRUE(rests[0].T_table_object.R.isIdentity());
}

// The footprint of whatever stands on the counter, from its vertices.
struct Standing {
  const Instance* instance;
  double low, high;
  std::vector<Vector3d> vertices;
};

std::vector<Standing> StandingThings(const Scene& scene) {
  std::vector<Standing> things;
  for (const Instance& instance : scene.instances) {
    Standing thing{&instance, 1e9, -1e9, {}};
    for (const Vector3& v : scene.meshes[static_cast<std::size_t>(instance.mesh)].vertices) {
      thing.vertices.push_back(instance.T_world_object * v.cast<double>());
      thing.low = std::min(thing.low, thing.vertices.back().z());
      thing.high = std::max(thing.high, thing.vertices.back().z());
    }
    if (std::abs(thing.low) < 1e-6 && thing.high > 0.01) things.push_back(thing);
  }
  return things;
}

// Some direction along the table keeps them apart (exact for convex footprints, up to the step of
// one degree).
bool AreApart(const Standing& a, const Standing& b) {
  for (int degree = 0; degree < 180; ++degree) {
    const Vector3d axis(std::cos(degree * kDegree), std::sin(degree * kDegree), 0);
    double a_low = 1e9, a_high = -1e9, b_low = 1e9, b_high = -1e9;
    for (const Vector3d& v : a.vertices) {
      a_low = std::min(a_low, axis.dot(v));
      a_high = std::max(a_high, axis.dot(v));
    }
    for (const Vector3d& v : b.vertices) {
      b_low = std::min(b_low, axis.dot(v));
      b_high = std::max(b_high, axis.dot(v));
    }
    if (a_high < b_low || b_high < a_low) return true;
  }
  return false;
}

ScenarioSpec SmallSpec() {
  ScenarioSpec spec;
  spec.camera.calibration = test::SmallCalibration();
  return spec;
}

TEST(Scenario, KitchenKeepsItsPromises) {
  int most_targets = 0;
  for (std::uint64_t seed = 0; seed < 25; ++seed) {
    const ScenarioSpec spec = SmallSpec();
    const auto scenario = MakeScenario(spec, seed, test::BoxAndBook());
    ASSERT_TRUE(scenario) << scenario.error();
    const std::vector<Standing> things = StandingThings(scenario->scene);
    int targets = 0;
    for (std::size_t i = 0; i < things.size(); ++i) {
      targets += things[i].instance->obj_id > 0 ? 1 : 0;
      for (std::size_t j = 0; j < i; ++j) {
        if (things[i].instance->obj_id > 0 || things[j].instance->obj_id > 0) {
          EXPECT_TRUE(AreApart(things[i], things[j])) << seed;
        }
      }
    }
    EXPECT_GE(targets, 1) << seed;
    most_targets = std::max(most_targets, targets);

    const double distance = (scenario->look_at - scenario->rig.T_world_left.t).norm();
    EXPECT_GE(distance, 0.69);
    EXPECT_LE(distance, 1.7);
    const Renderer renderer(scenario->scene);
    for (const ObjectTruth& object : FindTruth(renderer, LeftCamera(scenario->rig), 2).objects) {
      EXPECT_GT(object.visib_fract, 0.25) << "seed " << seed << " object " << object.obj_id;
    }
  }
  EXPECT_EQ(most_targets, 3);
}

TEST(Scenario, OrbitMovesSmoothlyAroundTheSamePlace) {
  ScenarioSpec spec = SmallSpec();
  spec.path.kind = PathKind::kOrbit;
  const auto scenario = MakeScenario(spec, 3, test::BoxAndBook());
  ASSERT_TRUE(scenario);
  EXPECT_TRUE(scenario->RigAt(0).T_world_left.R.isApprox(scenario->rig.T_world_left.R, 1e-12));
  const double distance = (scenario->rig.T_world_left.t - scenario->look_at).norm();
  for (int i = 0; i < 300; ++i) {
    const Pose a = scenario->RigAt(i / 30.0).T_world_left;
    const Pose b = scenario->RigAt((i + 1) / 30.0).T_world_left;
    EXPECT_NEAR((a.t - scenario->look_at).norm(), distance, 1e-9);
    EXPECT_LT((a.t - b.t).norm(), 0.01);
  }
}

// The blur follows the velocities; they must be those of the path.
TEST(Scenario, VelocitiesAreThePathsDerivatives) {
  ScenarioSpec spec = SmallSpec();
  spec.path.kind = PathKind::kDrive;
  spec.path.speed_m_per_s = {0.4, 0.4};
  spec.path.shake_deg = {0.5, 0.5};
  const auto scenario = MakeScenario(spec, 3, test::BoxAndBook());
  ASSERT_TRUE(scenario);
  for (int i = 1; i < 20; ++i) {
    const double t = 0.05 * i, step = 1e-4;
    const StereoRig rig = scenario->RigAt(t);
    const Pose later = scenario->RigAt(t + step).T_world_left, before = scenario->RigAt(t - step).T_world_left;
    EXPECT_LT((rig.velocity - (later.t - before.t) / (2 * step)).norm(), 1e-3);
    const Matrix3d turn = (later.R - before.R) / (2 * step) * rig.T_world_left.R.transpose();
    EXPECT_LT((turn - Skew(rig.rotation_rate)).norm(), 0.02 * rig.rotation_rate.norm() + 1e-3);
  }
  EXPECT_NEAR(scenario->RigAt(0.2).velocity.norm(), 0.4, 0.02);
}

TEST(Scenario, SaysWhenNothingFits) {
  const std::vector<TargetMesh> huge = {{1, "tower", {}, MakeBox({1, 1, 3})}};
  const auto scenario = MakeScenario(SmallSpec(), 1, huge);
  ASSERT_FALSE(scenario);
  EXPECT_NE(scenario.error().find("millimetres"), std::string::npos);
}

TEST(Scenario, SaysWhichModelIsMissing) {
  ScenarioSpec spec = SmallSpec();
  spec.objects[0].models = {"teapot"};
  const auto scenario = MakeScenario(spec, 1, test::BoxAndBook());
  ASSERT_FALSE(scenario);
  EXPECT_NE(scenario.error().find("teapot"), std::string::npos);
  EXPECT_NE(scenario.error().find("parcel_box, book"), std::string::npos);
}

}  // namespace
}  // namespace wirepose::sim
