#include "stages/line_evidence.h"

#include <algorithm>
#include <cmath>

namespace wirepose {
namespace {

constexpr float kPriorSegments = 2, kPriorPx = 50;

// The visible part of a model edge in the left image, from a to b.
struct VisibleEdge {
  std::span<const EdgeSample> samples;
  Vector2 a = Vector2::Zero();
  Vector2 direction = Vector2::Zero(), normal = Vector2::Zero();  // unit
  float length = 0;
  float before = 0, after = 0;  // how far the whole edge reaches beyond a and b, px
  bool outline = false;         // the background begins behind it

  [[nodiscard]] float Along(const Vector2& p) const { return (p - a).dot(direction); }
  [[nodiscard]] float Beside(const Vector2& p) const { return (p - a).dot(normal); }
  // Is the edge seen at p, or is there a gap where something hides it?
  [[nodiscard]] bool SeenAt(const Vector2& p) const {
    constexpr float kGapPx = 4;
    return std::any_of(samples.begin(), samples.end(),
                       [&](const EdgeSample& s) { return (s.left - p).squaredNorm() < kGapPx * kGapPx; });
  }
};

struct LineSums {
  float outline_px = 0, inner_px = 0;
  float crossings = 0, ends = 0, inner_crossings = 0;
  float along = 0, beyond = 0;  // px
};

class LineGatherer {
 public:
  LineGatherer(const LineEvidenceParams& params, const RectifiedCamera& camera, const PreparedModel& model,
               const Pose& T_camera_model)
      : params_(params), model_(model), projected_(camera, T_camera_model), towards_(model.view, projected_.Eye()) {}

  void Add(std::span<const EdgeSample> samples, std::span<const Segment2> segments) {
    VisibleEdge edge;
    if (!Place(samples, edge)) return;
    (edge.outline ? sums_.outline_px : sums_.inner_px) += edge.length;
    for (const Segment2& segment : segments) Compare(edge, segment);
  }

  [[nodiscard]] const LineSums& sums() const { return sums_; }

 private:
  bool Place(std::span<const EdgeSample> samples, VisibleEdge& edge) const {
    edge.samples = samples;
    edge.a = samples.front().left;
    const Vector2 delta = samples.back().left - edge.a;
    edge.length = delta.norm();
    if (edge.length <= params_.min_edge_px) return false;
    edge.direction = delta / edge.length;
    edge.normal = {-edge.direction.y(), edge.direction.x()};
    const std::size_t e = samples.front().edge;
    const float p = edge.Along(projected_.Pixel(model_.edges[e].a));
    const float q = edge.Along(projected_.Pixel(model_.edges[e].b));
    edge.before = std::max(0.0F, -std::min(p, q));
    edge.after = std::max(0.0F, std::max(p, q) - edge.length);
    edge.outline = towards_.IsOutline(model_.view.edges[e]);
    return true;
  }

  void Compare(const VisibleEdge& edge, const Segment2& segment) {
    const float a = edge.Beside(segment.a), b = edge.Beside(segment.b);
    const float nearer = std::min(std::abs(a), std::abs(b)), farther = std::max(std::abs(a), std::abs(b));
    const bool both_sides = a * b < 0;
    if (!both_sides && nearer >= params_.touch_px) return;
    const float cosine = std::abs(b - a) / segment.Length();
    if (cosine < params_.along_cosine) {
      if (farther < params_.along_px && std::abs(a + b) < 2 * params_.middle_px) AddAlong(edge, segment);
    } else if (cosine >= params_.min_cosine) {
      const bool crosses = both_sides && nearer > params_.cross_px;
      const bool ends = nearer < params_.touch_px && farther > params_.leave_px;
      if (!crosses && !ends) return;
      const Vector2 meeting = segment.a + a / (a - b) * (segment.b - segment.a);
      const float at = edge.Along(meeting);
      if (at < params_.corner_px || at > edge.length - params_.corner_px || !edge.SeenAt(meeting)) return;
      if (crosses) {
        (edge.outline ? sums_.crossings : sums_.inner_crossings) += 1;
      } else if (edge.outline) {
        sums_.ends += 1;
      }
    }
  }

  void AddAlong(const VisibleEdge& edge, const Segment2& segment) {
    const float a = edge.Along(segment.a), b = edge.Along(segment.b);
    const float low = std::min(a, b), high = std::max(a, b);
    const float shared = std::min(high, edge.length) - std::max(low, 0.0F);
    if (shared < params_.along_share * (high - low)) return;
    sums_.along += shared;
    sums_.beyond += std::max(0.0F, -low - edge.before - params_.touch_px) +
                    std::max(0.0F, high - edge.length - edge.after - params_.touch_px);
  }

  const LineEvidenceParams& params_;
  const PreparedModel& model_;
  ProjectedModel projected_;
  FacesTowards towards_;
  LineSums sums_;
};

// Lengths of the segments within the silhouette and of those that it cuts.
void MeasureTexture(std::span<const Segment2> segments, const SurfaceMap& surface, float& within, float& cut) {
  const auto covers = [&](const Vector2& p) {
    return surface.AtPixel(static_cast<int>(p.x()), static_cast<int>(p.y())) > 0;
  };
  for (const Segment2& segment : segments) {
    const bool a = covers(segment.a), b = covers(segment.b), middle = covers(segment.Middle());
    if (a && b && middle) {
      within += segment.Length();
    } else if (a || b || middle) {
      cut += segment.Length();
    }
  }
}

}  // namespace

void GatherLineEvidence(const LineEvidenceParams& params, const RectifiedCamera& camera,
                        std::span<const Segment2> segments, const PreparedModel& model, const Pose& T_camera_model,
                        const EdgeSamples& samples, const SurfaceMap& surface, LineEvidence& out) {
  LineGatherer gatherer(params, camera, model, T_camera_model);
  const std::span<const EdgeSample> all{samples.begin(), samples.end()};
  for (std::size_t first = 0; first < all.size();) {
    std::size_t end = first + 1;
    while (end < all.size() && all[end].edge == all[first].edge) ++end;
    gatherer.Add(all.subspan(first, end - first), segments);
    first = end;
  }
  float within = 0, cut = 0;
  MeasureTexture(segments, surface, within, cut);
  const LineSums& s = gatherer.sums();
  const float visible_px = s.outline_px + s.inner_px + kPriorPx;
  out.crossing = s.crossings / (s.crossings + s.ends + kPriorSegments);
  out.crossings = s.crossings / (s.outline_px / 100 + 1);
  out.inner_crossings = s.inner_crossings / (s.inner_px / 100 + 1);
  out.beyond = s.beyond / (s.along + kPriorPx / 2);
  out.within = within / visible_px;
  out.across = cut / visible_px;
  out.contained = within / (within + cut + kPriorPx);
}

}  // namespace wirepose
