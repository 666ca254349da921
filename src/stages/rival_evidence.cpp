#include "stages/rival_evidence.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/se3.h"

namespace wirepose {
namespace {

constexpr float kMinDepthM = 0.05F;
constexpr int kMaxSteps = 32;           // to each side; what would need more is looked at in wider steps
constexpr float kPriorSamples = 2;      // without an edge: few samples say little
constexpr std::size_t kMinSamples = 6;  // of the whole object
constexpr std::size_t kMaxAxes = 8;     // a box has three; of what has more the axes of the largest faces

using Sample = RivalScratch::Sample;
using Samples = FixedVector<Sample, kMaxEdgeSamples>;

struct Support {
  float both = 0, left = 0;  // in both images, in the left one
};

// Directions of a model edge in both images.
struct EdgeDirections {
  std::uint8_t left = 0, right = 0;
};

// Support of the rivals of one place, against the support there.
struct Rivals {
  float own = 0, best = 0, sum = 0, count = 0;

  void Add(float support) {
    best = std::max(best, support);
    sum += support;
    ++count;
  }
  [[nodiscard]] float Gain() const { return std::max(0.0F, best - own); }
  [[nodiscard]] float Peak() const { return count > 0 ? own - sum / count : 1.0F; }
};

class RivalGatherer {
 public:
  RivalGatherer(const RivalEvidenceParams& params, const RectifiedCamera& camera, const EdgeMap& left,
                const EdgeMap& right, const PreparedModel& model, const Pose& T_camera_model, RivalScratch& scratch)
      : params_(params),
        camera_(camera),
        left_(left),
        right_(right),
        model_(model),
        scratch_(scratch),
        R_(T_camera_model.R.cast<float>()),
        t_(T_camera_model.t.cast<float>()) {}

  void Run(const EdgeSamples& samples, RivalEvidence& out) {
    out = {};
    for (const PreparedFoot& foot : model_.feet) AddEnd(foot.face, samples, out);
    CollectAll(samples);
    const std::optional<Support> own = SupportOf(scratch_.all, Vector3::Zero());
    if (!own || scratch_.all.size() < kMinSamples) return;
    FixedVector<Vector3, kMaxAxes> axes;  // model frame
    for (const PreparedFoot& foot : model_.feet) {
      const Vector3 axis = NormalOf(foot.face);
      if (axes.full() ||
          std::any_of(axes.begin(), axes.end(), [&](const Vector3& a) { return std::abs(a.dot(axis)) > 0.95F; }))
        continue;
      axes.push_back(axis);
      AddMoved(axis, own->both, out);
      AddTurned(axis, own->both, out);
    }
  }

 private:
  [[nodiscard]] Vector3 NormalOf(std::uint16_t face) const {
    const auto& n = model_.view.faces[face].normal;
    return {n[0], n[1], n[2]};
  }

  void AddEnd(std::uint16_t face, const EdgeSamples& samples, RivalEvidence& out) {
    if (CollectEnd(face, samples) < params_.min_end_px) return;
    const std::optional<Support> own = SupportOf(scratch_.part, Vector3::Zero());
    if (!own) return;
    Rivals all{.own = own->both};
    ForEachMove(scratch_.part, R_ * NormalOf(face), [&](float side, const Support& rival) {
      const float gain = rival.both - own->both;
      if (gain > std::max(out.inward, out.outward)) {
        out.rival = rival.both;
        out.own = own->both;
      }
      float& best = side < 0 ? out.inward : out.outward;
      best = std::max(best, gain);
      out.left = std::max(out.left, rival.left - own->left);
      all.Add(rival.both);
    });
    out.end_peak = std::min(out.end_peak, all.Peak());
  }

  void AddMoved(const Vector3& axis, float own, RivalEvidence& out) const {
    Rivals all{.own = own};
    ForEachMove(scratch_.all, R_ * axis, [&](float, const Support& rival) { all.Add(rival.both); });
    out.moved = std::max(out.moved, all.Gain());
    out.moved_peak = std::min(out.moved_peak, all.Peak());
  }

  void AddTurned(const Vector3& axis, float own, RivalEvidence& out) {
    Rivals all{.own = own};
    const float step =
        (params_.max_turn_rad - params_.min_turn_rad) / static_cast<float>(std::max(params_.turns - 1, 1));
    for (int k = 0; k < params_.turns; ++k) {
      for (const float side : {-1.0F, 1.0F}) {
        Turn(R_ * axis, side * (params_.min_turn_rad + static_cast<float>(k) * step));
        const std::optional<Support> rival = SupportOf(scratch_.part, Vector3::Zero());
        if (rival) all.Add(rival->both);
      }
    }
    out.turned = std::max(out.turned, all.Gain());
    out.turned_peak = std::min(out.turned_peak, all.Peak());
  }

  // Fills scratch_.part with all samples, turned about an axis (camera frame) through the object's centre.
  void Turn(const Vector3& axis, float angle_rad) {
    const Vector3 centre = R_ * model_.centre + t_;
    const Matrix3 Q = ExpSo3((static_cast<double>(angle_rad) * axis.cast<double>()).eval()).cast<float>();
    const Matrix3 QR = Q * R_;
    const Vector3 shift = Q * (t_ - centre) + centre;
    scratch_.part.clear();
    std::size_t edge = kMaxModelEdges;
    EdgeDirections directions;
    for (Sample s : scratch_.all) {
      s.at = Q * (s.at - centre) + centre;
      if (s.edge != edge) {
        edge = s.edge;
        directions = DirectionsOf(QR * model_.edges[edge].a + shift, QR * model_.edges[edge].b + shift);
      }
      s.direction = directions.left;
      s.direction_right = directions.right;
      scratch_.part.push_back(s);
    }
  }

  [[nodiscard]] EdgeDirections DirectionsOf(const Vector3& a, const Vector3& b) const {
    if (a.z() < kMinDepthM || b.z() < kMinDepthM) return {};
    const Vector2 left = Pixel(b) - Pixel(a);
    const float right_x = left.x() - (Disparity(b) - Disparity(a));
    return {static_cast<std::uint8_t>(EdgeMap::Direction(left.x(), left.y())),
            static_cast<std::uint8_t>(EdgeMap::Direction(right_x, left.y()))};
  }

  [[nodiscard]] Sample SampleOf(const EdgeSample& s) const {
    return {R_ * s.point + t_, s.edge, static_cast<std::uint8_t>(EdgeMap::Direction(s.tangent.x(), s.tangent.y())),
            static_cast<std::uint8_t>(EdgeMap::Direction(s.tangent_right.x(), s.tangent_right.y()))};
  }

  void CollectAll(const EdgeSamples& samples) {
    scratch_.all.clear();
    for (std::size_t i = 0; i < samples.size(); i += 2) scratch_.all.push_back(SampleOf(samples[i]));
  }

  // Every second sample of the edges around a face into scratch_.part; gives their length, px.
  float CollectEnd(std::uint16_t face, const EdgeSamples& samples) {
    scratch_.part.clear();
    float length = 0;
    bool keep = false;
    for (const EdgeSample& s : samples) {
      const auto& faces = model_.view.edges[s.edge].face;
      if (faces[0] != face && faces[1] != face) continue;
      length += s.weight_px;
      keep = !keep;
      if (keep) scratch_.part.push_back(SampleOf(s));
    }
    return length;
  }

  // Calls use(side, support) for each place along a unit vector (camera frame) at which most of the samples are seen.
  template <typename Use>
  void ForEachMove(const Samples& samples, const Vector3& along, const Use& use) const {
    const Vector3 reach = params_.reach * model_.view.diameter_m * along;
    const float reach_px = std::max({MovePx(samples, reach), MovePx(samples, -reach), 1.0F});
    const int steps = std::clamp(static_cast<int>(reach_px / params_.step_px), 1, kMaxSteps);
    const float share = 1 / static_cast<float>(steps);
    const int first = static_cast<int>(std::ceil(params_.min_move_px / (share * reach_px)));
    for (int k = first; k <= steps; ++k) {
      for (const float side : {-1.0F, 1.0F}) {
        const std::optional<Support> support = SupportOf(samples, side * share * static_cast<float>(k) * reach);
        if (support) use(side, *support);
      }
    }
  }

  [[nodiscard]] float Disparity(const Vector3& p) const {
    return static_cast<float>(camera_.baseline * camera_.f) / p.z();
  }

  [[nodiscard]] Vector2 Pixel(const Vector3& p) const {
    const float scale = static_cast<float>(camera_.f) / p.z();
    return {scale * p.x() + static_cast<float>(camera_.cx), scale * p.y() + static_cast<float>(camera_.cy)};
  }

  // The farthest that a sample moves in the image.
  [[nodiscard]] float MovePx(const Samples& samples, const Vector3& move) const {
    float farthest = 0;
    for (const Sample& s : samples) {
      const Vector3 moved = s.at + move;
      if (moved.z() > kMinDepthM) farthest = std::max(farthest, (Pixel(moved) - Pixel(s.at)).squaredNorm());
    }
    return std::sqrt(farthest);
  }

  // Of the samples moved so far; none when most of them would lie outside of the image.
  [[nodiscard]] std::optional<Support> SupportOf(const Samples& samples, const Vector3& move) const {
    std::size_t inside = 0;
    Support support;
    for (const Sample& s : samples) {
      const Vector3 p = s.at + move;
      if (p.z() < kMinDepthM) continue;
      const Vector2 u = Pixel(p);
      if (!left_.Contains(u.x(), u.y())) continue;
      ++inside;
      if (!left_.HasEdge(u.x(), u.y(), s.direction)) continue;
      ++support.left;
      const float x = u.x() - Disparity(p);
      if (!right_.Contains(x, u.y()) || right_.HasEdge(x, u.y(), s.direction_right)) ++support.both;
    }
    if (2 * inside < samples.size()) return {};
    const float scale = 1 / (static_cast<float>(inside) + kPriorSamples);
    return Support{support.both * scale, support.left * scale};
  }

  const RivalEvidenceParams& params_;
  const RectifiedCamera& camera_;
  const EdgeMap& left_;
  const EdgeMap& right_;
  const PreparedModel& model_;
  RivalScratch& scratch_;
  Matrix3 R_;
  Vector3 t_;
};

}  // namespace

void GatherRivalEvidence(const RivalEvidenceParams& params, const RectifiedCamera& camera, const EdgeMap& left,
                         const EdgeMap& right, const PreparedModel& model, const Pose& T_camera_model,
                         const EdgeSamples& samples, RivalScratch& scratch, RivalEvidence& out) {
  RivalGatherer(params, camera, left, right, model, T_camera_model, scratch).Run(samples, out);
}

}  // namespace wirepose
