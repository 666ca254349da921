// What segments say about a pose, on segments drawn by hand: counts and lengths are known exactly.
#include "stages/line_evidence.h"

#include <gtest/gtest.h>

#include "model_test_support.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::Random;

constexpr LineEvidenceParams kParams;

Segment2 Between(const Vector2& a, const Vector2& b) {
  Segment2 segment;
  segment.a = a;
  segment.b = b;
  return segment;
}

class LineEvidenceTest : public ::testing::Test {
 protected:
  // The box with three faces in view and what of it is seen.
  void SetUp() override { Look(View()); }

  [[nodiscard]] Pose View() const {
    Pose T;
    T.R = ExpSo3({0.5, 0, 0}) * ExpSo3({0, 0.6, 0}) * (Matrix3d() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished();
    T.t = Vector3d(0, 0, 0.8) - T.R * model_->centre.cast<double>();
    return T;
  }

  void Look(const Pose& T) {
    T_ = T;
    SampleVisibleEdges({.step_px = 4}, camera_, *model_, T_, *front_, *samples_);
    RenderSurface(camera_, *model_, T_, *surface_);
  }

  [[nodiscard]] LineEvidence Gather(const std::vector<Segment2>& segments) const {
    LineEvidence out;
    GatherLineEvidence(kParams, camera_, segments, *model_, T_, *samples_, *surface_, out);
    return out;
  }

  [[nodiscard]] bool IsOutline(std::size_t edge) const {
    const Vector3 eye = -(T_.R.transpose() * T_.t).cast<float>();
    int towards = 0;
    for (const std::uint16_t f : model_->view.edges[edge].face)
      towards += IsTowards(model_->view.faces[f], eye) ? 1 : 0;
    return towards == 1;
  }

  // Image positions of an edge's ends.
  [[nodiscard]] std::pair<Vector2, Vector2> Ends(std::size_t edge) const {
    const auto project = [&](const Vector3& p) -> Vector2 {
      return camera_.Project(T_ * p.cast<double>()).head<2>().cast<float>();
    };
    return {project(model_->edges[edge].a), project(model_->edges[edge].b)};
  }

  // Visible edges, those of the outline or the others.
  [[nodiscard]] std::vector<std::size_t> Edges(bool outline) const {
    std::vector<std::size_t> edges;
    for (const EdgeSample& s : *samples_) {
      if ((edges.empty() || edges.back() != s.edge) && IsOutline(s.edge) == outline) edges.push_back(s.edge);
    }
    return edges;
  }

  // Across the middle of an edge at 60 degrees, from `from` px on one side to `to` px on the other.
  [[nodiscard]] Segment2 Across(std::size_t edge, float from, float to) const {
    const auto [a, b] = Ends(edge);
    const Vector2 u = (b - a).normalized(), n(-u.y(), u.x());
    const Vector2 d = 0.5F * u + 0.866F * n, middle = 0.5F * (a + b);
    return Between(middle - from * d, middle + to * d);
  }

  RectifiedCamera camera_ = testing::TestCamera();
  testing::TestModel model_ = testing::Load("parcel_box");
  Pose T_;
  std::unique_ptr<FrontTriangles> front_ = std::make_unique<FrontTriangles>();
  std::unique_ptr<EdgeSamples> samples_ = std::make_unique<EdgeSamples>();
  std::unique_ptr<SurfaceMap> surface_ = std::make_unique<SurfaceMap>();
};

TEST_F(LineEvidenceTest, TheModelsOwnEdgesSpeakAgainstNothing) {
  std::vector<Segment2> segments;
  for (const bool outline : {true, false}) {
    for (const std::size_t e : Edges(outline)) {
      const auto [a, b] = Ends(e);
      segments.push_back(Between(a, b));
    }
  }
  ASSERT_EQ(segments.size(), 9u);
  const LineEvidence out = Gather(segments);
  EXPECT_EQ(out.crossing, 0);
  EXPECT_EQ(out.crossings, 0);
  EXPECT_EQ(out.inner_crossings, 0);
  EXPECT_EQ(out.beyond, 0);
  const LineEvidence none = Gather({});
  EXPECT_EQ(none.crossing, 0);
  EXPECT_EQ(none.within, 0);
  EXPECT_EQ(none.contained, 0);
}

TEST_F(LineEvidenceTest, CrossingAndEndingSegmentsAreCounted) {
  const auto outline = Edges(true);
  ASSERT_EQ(outline.size(), 6u);
  std::vector<Segment2> segments = {Across(outline[0], 20, 20), Across(outline[1], 12, 30)};
  EXPECT_FLOAT_EQ(Gather(segments).crossing, 2.0F / 4);
  segments.push_back(Across(outline[2], 2, 25));   // ends at the edge
  segments.push_back(Across(outline[3], 25, -2));  // ends 2 px before it
  segments.push_back(Across(outline[4], 40, -9));  // has nothing to do with it
  segments.push_back(Across(outline[5], 4, 5));    // too short to say
  EXPECT_FLOAT_EQ(Gather(segments).crossing, 2.0F / 6);
  EXPECT_EQ(Gather(segments).inner_crossings, 0);
  const float per_100_px = Gather(segments).crossings;
  segments.push_back(Across(Edges(false)[0], 20, 20));
  EXPECT_GT(Gather(segments).inner_crossings, 0);
  EXPECT_FLOAT_EQ(Gather(segments).crossings, per_100_px);
}

// Where the edge is hidden nothing can cross it.
TEST_F(LineEvidenceTest, CrossingsInAGapDoNotCount) {
  const std::size_t edge = Edges(true)[0];
  const std::vector<Segment2> segments = {Across(edge, 20, 20)};
  ASSERT_GT(Gather(segments).crossing, 0);
  const Vector2 middle = segments[0].Middle();
  std::size_t kept = 0;
  for (const EdgeSample& s : *samples_) {
    if (s.edge != edge || (s.left - middle).norm() > 10) (*samples_)[kept++] = s;
  }
  samples_->resize(kept);
  EXPECT_EQ(Gather(segments).crossing, 0);
}

// A segment that runs on beyond a corner: by the length beyond, but for the 4 px of the corner itself.
TEST_F(LineEvidenceTest, LengthBeyondTheEnds) {
  const auto [a, b] = Ends(Edges(true)[0]);
  const Vector2 u = (b - a).normalized();
  const auto first =
      std::find_if(samples_->begin(), samples_->end(), [&](const EdgeSample& s) { return s.edge == Edges(true)[0]; });
  float along = 0;
  for (auto s = first; s != samples_->end() && s->edge == first->edge; ++s) along = (s->left - first->left).norm();
  const float none = Gather({Between(a, b)}).beyond;
  EXPECT_EQ(none, 0);
  EXPECT_NEAR(Gather({Between(a - 24 * u, b)}).beyond, 20 / (along + 25), 1e-3F);
  EXPECT_NEAR(Gather({Between(b + 34 * u, a - 24 * u)}).beyond, 50 / (along + 25), 1e-3F);
  // Most of it elsewhere: another line.
  EXPECT_EQ(Gather({Between(b - 20 * u, b + 200 * u)}).beyond, 0);
}

TEST_F(LineEvidenceTest, TextureWithinAndAcrossTheSilhouette) {
  const Vector2 centre = camera_.Project(T_ * model_->centre.cast<double>()).head<2>().cast<float>();
  const Segment2 print = Between(centre + Vector2(-20, 10), centre + Vector2(20, 10));
  const LineEvidence within = Gather({print});
  EXPECT_GT(within.within, 0);
  EXPECT_EQ(within.across, 0);
  EXPECT_FLOAT_EQ(within.contained, 40.0F / 90);
  const LineEvidence both = Gather({print, Between(centre, Vector2(5, centre.y()))});
  EXPECT_FLOAT_EQ(both.within, within.within);
  EXPECT_GT(both.across, 0);
  EXPECT_LT(both.contained, within.contained);
  EXPECT_EQ(Gather({Between({3, 3}, {60, 3})}).across, 0);
}

// Does the segment cross (1) the line from a to b well within both, end at it (2) or neither (0)? Solved as two
// equations in two unknowns; -1: too close to a bound to tell.
int MeetingByCramer(const EdgeSample& first, const EdgeSample& last, const std::vector<EdgeSample>& samples,
                    const Segment2& s) {
  const Eigen::Vector2d p = first.left.cast<double>(), r = last.left.cast<double>() - p;
  const Eigen::Vector2d q = s.a.cast<double>(), t = s.b.cast<double>() - q;
  const double det = r.x() * t.y() - r.y() * t.x();
  const double sine = std::abs(det) / (r.norm() * t.norm());
  const auto close = [](double value, double bound) { return std::abs(value - bound) < 1e-3; };
  if (close(sine, 0.35)) return -1;
  if (sine < 0.35) return 0;
  const double along = ((q - p).x() * t.y() - (q - p).y() * t.x()) / det * r.norm();
  const double where = ((q - p).x() * r.y() - (q - p).y() * r.x()) / det;  // 0: at s.a, 1: at s.b
  if (close(along, 5) || close(along, r.norm() - 5)) return -1;
  if (along < 5 || along > r.norm() - 5) return 0;
  const double one = std::abs(where) * t.norm() * sine, other = std::abs(1 - where) * t.norm() * sine;
  const double nearer = std::min(one, other), farther = std::max(one, other);
  if (close(nearer, 4) || close(nearer, 5) || close(farther, 8) || close(where, 0) || close(where, 1)) return -1;
  double gap = 1e9;
  const Eigen::Vector2d meeting = q + where * t;
  for (const EdgeSample& e : samples) gap = std::min(gap, (e.left.cast<double>() - meeting).norm());
  if (close(gap, 4)) return -1;
  if (gap > 4) return 0;
  if (where > 0 && where < 1 && nearer > 5) return 1;
  return nearer < 4 && farther > 8 ? 2 : 0;
}

TEST_F(LineEvidenceTest, AgreesWithBruteForce) {
  Random random(3);
  int met = 0;
  for (int k = 0; k < Cases(2000); ++k) {
    Look(testing::AnyView(random, *model_, camera_, 250));
    std::map<std::size_t, std::vector<EdgeSample>> edges;
    for (const EdgeSample& s : *samples_) edges[s.edge].push_back(s);
    const auto anywhere = [&]() -> Vector2 {
      return {static_cast<float>(random.Uniform(150, 490)), static_cast<float>(random.Uniform(70, 410))};
    };
    float crossings = 0, ends = 0;
    std::vector<Segment2> segments;
    while (segments.size() < 12) {
      const Segment2 s = Between(anywhere(), anywhere());
      int here[3] = {};
      bool undecided = s.Length() < 12;
      for (const auto& [e, samples] : edges) {
        if (!IsOutline(e) || (samples.back().left - samples.front().left).norm() <= kParams.min_edge_px) continue;
        const int meeting = MeetingByCramer(samples.front(), samples.back(), samples, s);
        undecided = undecided || meeting < 0;
        if (meeting >= 0) ++here[meeting];
      }
      if (undecided) continue;
      segments.push_back(s);
      crossings += static_cast<float>(here[1]);
      ends += static_cast<float>(here[2]);
    }
    met += static_cast<int>(crossings + ends);
    ASSERT_NEAR(Gather(segments).crossing, crossings / (crossings + ends + 2), 1e-5F) << k;
  }
  EXPECT_GT(met, Cases(2000));
}

}  // namespace
}  // namespace wirepose
