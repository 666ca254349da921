#include "stages/edge_summary.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace wirepose {
namespace {

constexpr float kFull = 0.8F, kWeak = 0.4F;  // support of an edge that is there, and of one that is not

// How the visible edges that meet at a corner, or bound a face, are supported.
struct CornerSums {
  std::uint16_t edges = 0, held = 0;
};
struct FaceSums {
  float samples = 0, hits = 0, length_px = 0;
};

class Summary {
 public:
  Summary(const VerifyParams& params, const PreparedModel& model, const Pose& T_camera_model)
      : params_(params),
        model_(model),
        towards_(model.view, -(T_camera_model.R.transpose() * T_camera_model.t).cast<float>()) {}

  void Add(std::size_t edge, const EdgeSums& e) {
    all_.Add(e);
    for (const std::uint16_t face : model_.view.edges[edge].face) {
      if (!towards_.Has(face)) continue;
      faces_[face].samples += e.samples;
      faces_[face].hits += e.hits;
      faces_[face].length_px += e.length_px;
    }
    (towards_.IsOutline(model_.view.edges[edge]) ? outline_ : inner_).Add(e);
    if (e.hits > 3) {
      variance_ += e.offset_squared - e.offset * e.offset / e.hits;
      spread_hits_ += e.hits;
    }
    if (e.length_px >= params_.min_edge_px && e.samples >= 3) AddLong(edge, e);
  }

  void Write(float total_px, EdgeEvidence& out) const {
    out = {};
    out.visible_px = all_.length_px;
    out.inside = Share(all_.length_px, total_px);
    out.edges = edges_;
    out.support = Share(all_.hits, all_.samples);
    out.chance = Share(all_.chance_hits, all_.chances);
    out.sharp = Share(all_.sharp, all_.samples);
    out.sharp_of_support = Share(all_.sharp, all_.hits);
    out.spread_px = spread_hits_ > 0 ? std::sqrt(std::max(0.0F, variance_ / spread_hits_)) : params_.max_offset_px;
    out.parallax_px = Parallax();
    out.full_edges = Share(full_edges_, edges_);
    out.weak_edges = Share(weak_edges_, edges_);
    out.weakest_edge = weakest_;
    out.distinct = Share(all_.distinct, all_.piece_px);
    out.clear = Share(all_.clear, all_.piece_px);
    out.dimmest_edge = dimmest_;
    out.outline = Share(outline_.hits, outline_.samples);
    out.outline_distinct = Share(outline_.distinct, outline_.piece_px);
    // A single face has no inner edges: they neither help nor harm.
    out.inner_distinct = inner_.piece_px > 0 ? Share(inner_.distinct, inner_.piece_px) : out.distinct;
    out.ends = Share(ends_, 2 * edges_);
    WriteCorners(out);
    WriteFaces(out);
  }

 private:
  // What each edge of some length has a say in.
  void AddLong(std::size_t edge, const EdgeSums& e) {
    const float support = Share(e.hits, e.samples);
    edges_ += 1;
    full_edges_ += support > kFull ? 1.0F : 0.0F;
    weak_edges_ += support < kWeak ? 1.0F : 0.0F;
    weakest_ = std::min(weakest_, support);
    dimmest_ = std::min(dimmest_, Share(e.distinct, e.piece_px));
    const std::array<bool, 2> held = {e.first.held(), e.last().held()};
    for (std::size_t end = 0; end < 2; ++end) {
      CornerSums& corner = corners_[model_.view.edges[edge].vertex[end]];
      ++corner.edges;
      if (!held[end]) continue;
      ++corner.held;
      ends_ += 1;
    }
  }

  // Root mean square difference of both images' offsets that no common disparity explains: a rig or a model of a
  // slightly wrong size shifts all edges alike.
  [[nodiscard]] float Parallax() const {
    if (all_.hits == 0) return params_.max_offset_px;
    const float common = Share(all_.parallax_across * all_.parallax_across, all_.across_squared);
    return std::sqrt(std::max(0.0F, all_.parallax_squared - common) / all_.hits);
  }

  void WriteCorners(EdgeEvidence& out) const {
    float corners = 0, held = 0;
    for (const CornerSums& corner : corners_) {
      if (corner.edges < 2) continue;
      corners += 1;
      held += corner.held == corner.edges ? 1.0F : 0.0F;
    }
    out.corners = Share(held, corners);
  }

  void WriteFaces(EdgeEvidence& out) const {
    out.weakest_face = 1;
    for (const FaceSums& face : faces_) {
      if (face.length_px < 4 * params_.min_edge_px) continue;
      out.weakest_face = std::min(out.weakest_face, Share(face.hits, face.samples));
    }
  }

  const VerifyParams& params_;
  const PreparedModel& model_;
  FacesTowards towards_;
  EdgeSums all_, outline_, inner_;
  float variance_ = 0, spread_hits_ = 0;
  float edges_ = 0, full_edges_ = 0, weak_edges_ = 0, ends_ = 0, weakest_ = 1, dimmest_ = 1;
  std::array<CornerSums, kMaxModelVertices> corners_{};
  std::array<FaceSums, kMaxModelFaces> faces_{};
};

}  // namespace

void SummarizeEdges(const VerifyParams& params, const PreparedModel& model, const Pose& T_camera_model,
                    std::span<const EdgeSums> sums, float total_px, EdgeEvidence& out) {
  Summary summary(params, model, T_camera_model);
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    if (sums[e].samples > 0) summary.Add(e, sums[e]);
  }
  summary.Write(total_px, out);
}

}  // namespace wirepose
