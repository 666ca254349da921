// Symmetries, aspects and line sets against brute force.
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "tests/mesh/test_meshes.h"
#include "tests/tools/model_test_options.h"
#include "tools/model_compiler/aspects.h"

namespace wirepose {
namespace {

using mesh::Mesh;
using testing::BoxMesh;
using tools::CompiledModel;

CompiledModel Compile(const Mesh& mesh) { return tools::CompileModel(mesh, testing::TestOptions()).value(); }

Matrix3d RandomRotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

Mesh Moved(const Mesh& mesh, const Pose& T) {
  Mesh moved = mesh;
  for (auto& v : moved.vertices) v = T * v;
  return moved;
}

// --- Symmetries
// ---------------------------------------------------------------------------------------------------------

// Each symmetry must map the set of vertices onto itself, and no two may be the same.
void ExpectGroup(const ModelView& m) {
  for (std::size_t i = 0; i < m.symmetries.size(); ++i) {
    const ModelSymmetry& s = m.symmetries[i];
    const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> R(s.rotation);
    for (std::size_t v = 0; v < m.vertices.size(); ++v) {
      const Vector3 p = R * m.VertexPosition(v) + Vector3(s.translation_m);
      float nearest = std::numeric_limits<float>::infinity();
      for (std::size_t w = 0; w < m.vertices.size(); ++w) nearest = std::min(nearest, (p - m.VertexPosition(w)).norm());
      EXPECT_LT(nearest, 2e-3F * m.diameter_m);
    }
    EXPECT_LT(R.trace(), 2.999F) << "the identity is not stored";
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> Q(m.symmetries[j].rotation);
      EXPECT_GT((R - Q).norm(), 0.1F);
    }
  }
}

TEST(ModelSymmetry, KnownGroupsInAnyPose) {
  std::mt19937 random(6);
  const std::pair<Mesh, std::size_t> cases[] = {
      {BoxMesh(0.3, 0.2, 0.15), 3},            // three half turns
      {BoxMesh(0.2, 0.2, 0.3), 7},             // a square prism: D4
      {BoxMesh(0.1, 0.1, 0.1), 23},            // a cube
      {testing::PrismMesh(3, 0.1, 0.3), 5},    // D3
      {testing::PrismMesh(5, 0.1, 0.3), 9},    // D5
      {testing::PrismMesh(12, 0.1, 0.3), 23},  // D12, just within the capacity
      {testing::TwoPartMesh(), 0},
  };
  for (const auto& [mesh, expected] : cases) {
    for (int i = 0; i < 6; ++i) {
      const CompiledModel model = Compile(Moved(mesh, {RandomRotation(random), Vector3d(0.3, -0.2, 0.9)}));
      EXPECT_EQ(model.View().symmetries.size(), expected);
      ExpectGroup(model.View());
    }
  }
}

TEST(ModelSymmetry, LargeGroupsShrinkToASubgroup) {
  const CompiledModel model = Compile(testing::PrismMesh(48, 0.1, 0.3));  // D48 has 96 elements
  EXPECT_EQ(model.View().symmetries.size(), 23U);
  ExpectGroup(model.View());
  EXPECT_FALSE(model.notes.empty());
}

TEST(ModelSymmetry, NearlyEqualSidesAreNotEqual) {
  EXPECT_EQ(Compile(BoxMesh(0.2, 0.203, 0.3)).View().symmetries.size(), 3U);
}

// --- Aspects
// ------------------------------------------------------------------------------------------------------------

// Moeller and Trumbore 1997, all triangles, double precision.
bool BlockedBruteForce(const ModelView& m, const Vector3d& from, const Vector3d& to, double gap) {
  const Vector3d d = to - from;
  for (const ModelTriangle& t : m.triangles) {
    const Vector3d a = m.VertexPosition(t.vertex[0]).cast<double>();
    const Vector3d e1 = m.VertexPosition(t.vertex[1]).cast<double>() - a,
                   e2 = m.VertexPosition(t.vertex[2]).cast<double>() - a;
    const Vector3d p = d.cross(e2), s = from - a, q = s.cross(e1);
    const double det = e1.dot(p);
    if (std::abs(det) < 1e-15) continue;
    const double u = s.dot(p) / det, v = d.dot(q) / det, at = e2.dot(q) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && at > 0 && at * d.norm() < d.norm() - gap) return true;
  }
  return false;
}

TEST(ModelAspects, AgreeWithBruteForce) {
  std::mt19937 random(7);
  for (const Mesh& mesh : {testing::TwoPartMesh(), testing::PrismMesh(5, 0.1, 0.3)}) {
    const CompiledModel model = Compile(Moved(mesh, {RandomRotation(random), Vector3d(0.1, 0.2, -0.3)}));
    const ModelView m = model.View();
    const double diameter = static_cast<double>(m.diameter_m);
    const Vector3d centre = (m.box_min_m + m.box_max_m).cast<double>() / 2;
    int different = 0, visible = 0;
    for (const ModelAspect& a : m.aspects) {
      EXPECT_FLOAT_EQ(a.distance_m, 3 * m.diameter_m);
      const Vector3d camera = centre + 3 * diameter * Vector3(a.direction).cast<double>();
      for (std::size_t e = 0; e < m.edges.size(); ++e) {
        const ModelEdge& edge = m.edges[e];
        bool faces_camera = edge.face[1] == kNoFace;
        for (const std::uint16_t f : edge.face) {
          faces_camera |=
              Vector3(m.faces[f].normal).cast<double>().dot(camera) > static_cast<double>(m.faces[f].offset_m);
        }
        int samples = 0;
        for (int k = 0; k < 16 && faces_camera; ++k) {
          const double s = (k + 0.5) / 16;
          const Vector3d p = (1 - s) * m.VertexPosition(edge.vertex[0]).cast<double>() +
                             s * m.VertexPosition(edge.vertex[1]).cast<double>();
          if (!BlockedBruteForce(m, camera, p, 1e-3 * diameter)) ++samples;
        }
        const bool bit = (a.visible_edges[e / 32] >> (e % 32) & 1U) != 0;
        visible += bit ? 1 : 0;
        different += bit != (samples >= 8) ? 1 : 0;
      }
    }
    EXPECT_GT(visible, 100);
    EXPECT_LE(different, 2) << "ties of single precision apart, both must agree";
  }
}

TEST(ModelAspects, BoxShowsFourSevenOrNineEdges) {
  const CompiledModel model = Compile(BoxMesh(0.3, 0.2, 0.15));
  std::map<int, int> views_by_count;
  for (const ModelAspect& a : model.View().aspects) ++views_by_count[__builtin_popcount(a.visible_edges[0])];
  for (const auto& [count, views] : views_by_count) EXPECT_TRUE(count == 4 || count == 7 || count == 9) << count;
  EXPECT_GT(views_by_count[9], 80);  // most directions see three faces
}

TEST(ModelAspects, DirectionsAreEvenlySpread) {
  const auto directions = tools::SphereDirections(2);
  ASSERT_EQ(directions.size(), kMaxModelAspects);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    EXPECT_NEAR(directions[i].norm(), 1, 1e-12);
    double nearest = -1;
    for (std::size_t j = 0; j < directions.size(); ++j) {
      if (j != i) nearest = std::max(nearest, directions[i].dot(directions[j]));
    }
    const double degrees = std::acos(nearest) * 180 / M_PI;
    EXPECT_GT(degrees, 14);
    EXPECT_LT(degrees, 19);
  }
}

// --- Line sets (paper section 3.1)
// --------------------------------------------------------------------------------------

// Smallest value of a function that is convex along a line, by a search on [-50, 50] m.
template <typename Function>
double Smallest(const Function& distance) {
  double low = -50, high = 50;
  for (int i = 0; i < 200; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
  }
  return distance((low + high) / 2);
}

void ExpectMemberMatches(const ModelView& m, const ModelLineSet& set, const ModelSetMember& member) {
  const ModelEdge& b = m.edges[set.base_edge];
  const ModelEdge& o = m.edges[member.edge];
  const Vector3d p = m.VertexPosition(b.vertex[0]).cast<double>(), p2 = m.VertexPosition(b.vertex[1]).cast<double>();
  const Vector3d q = m.VertexPosition(o.vertex[0]).cast<double>(), q2 = m.VertexPosition(o.vertex[1]).cast<double>();
  const Vector3d d = (p2 - p).normalized(), e = (q2 - q).normalized();
  const double angle = std::acos(std::min(1.0, std::abs(d.dot(e))));
  EXPECT_NEAR(static_cast<double>(member.angle_rad), angle, 1e-3);
  EXPECT_EQ(set.kind == LineSetKind::kParallel, angle < 1.0 * M_PI / 180);
  // Of lines that are parallel up to rounding, the common perpendicular may lie anywhere: the
  // member's middle counts.
  const double lambda = set.kind == LineSetKind::kParallel
                            ? Smallest([&](double s) { return (p + s * d - (q + q2) / 2).norm(); })
                            : Smallest([&](double s) { return e.cross(p + s * d - q).norm(); });
  EXPECT_NEAR(static_cast<double>(member.distance_m), lambda, 1e-6);
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const Vector3d& x : {p, p2}) {
    for (const Vector3d& y : {q, q2}) {
      nearest = std::min(nearest, (x - y).norm());
      farthest = std::max(farthest, (x - y).norm());
    }
  }
  EXPECT_NEAR(static_cast<double>(member.nearest_end_m), nearest, 1e-6);
  EXPECT_NEAR(static_cast<double>(member.farthest_end_m), farthest, 1e-6);
  int common = 0;
  for (const std::uint16_t f : b.face) common += f != kNoFace && (f == o.face[0] || f == o.face[1]) ? 1 : 0;
  EXPECT_EQ(member.common_faces, common);
}

bool SeenTogether(const ModelView& m, std::size_t i, std::size_t j) {
  for (const ModelAspect& a : m.aspects) {
    if ((a.visible_edges[i / 32] >> (i % 32) & a.visible_edges[j / 32] >> (j % 32) & 1U) != 0) return true;
  }
  return false;
}

TEST(ModelLineSets, ParameterVectorsAgreeWithBruteForce) {
  std::mt19937 random(8);
  for (const Mesh& mesh : {BoxMesh(0.3, 0.2, 0.15), testing::TwoPartMesh(), testing::PrismMesh(5, 0.1, 0.3)}) {
    const CompiledModel model = Compile(Moved(mesh, {RandomRotation(random), Vector3d(0.1, 0.2, -0.3)}));
    const ModelView m = model.View();
    std::size_t pairs = 0;
    for (const ModelLineSet& set : m.line_sets) {
      float previous = -1;
      for (std::uint32_t k = 0; k < set.member_count; ++k, ++pairs) {
        const ModelSetMember& member = m.set_members[set.first_member + k];
        ExpectMemberMatches(m, set, member);
        EXPECT_TRUE(SeenTogether(m, set.base_edge, member.edge));
        EXPECT_GE(member.nearest_end_m, previous);
        previous = member.nearest_end_m;
      }
    }
    // Complete: every ordered pair of edges that some aspect shows together is in exactly one set.
    std::size_t expected = 0;
    for (std::size_t i = 0; i < m.edges.size(); ++i) {
      for (std::size_t j = 0; j < m.edges.size(); ++j) expected += i != j && SeenTogether(m, i, j) ? 1 : 0;
    }
    EXPECT_EQ(pairs, expected);
  }
}

TEST(ModelLineSets, CornersOfABoxAreLJunctions) {
  const CompiledModel model = Compile(BoxMesh(0.3, 0.2, 0.15));
  const ModelView m = model.View();
  for (const ModelLineSet& set : m.line_sets) {
    if (set.kind == LineSetKind::kParallel) {
      EXPECT_EQ(set.member_count, 3U);
      EXPECT_EQ(set.face_count, 4U);
      continue;
    }
    // phi = pi/2 and delta_d = 0: the two neighbours at each of the base line's two corners.
    for (std::uint32_t k = 0; k < 4; ++k) {
      const ModelSetMember& member = m.set_members[set.first_member + k];
      EXPECT_NEAR(member.angle_rad, M_PI / 2, 1e-5);
      EXPECT_EQ(member.nearest_end_m, 0);
    }
    EXPECT_GT(m.set_members[set.first_member + 4].nearest_end_m, 0.1F);
  }
}

}  // namespace
}  // namespace wirepose
