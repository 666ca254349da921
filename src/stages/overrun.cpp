#include "stages/overrun.h"

#include <algorithm>
#include <array>

namespace wirepose {
namespace {

constexpr float kMinLengthPx = 25;
constexpr std::array<float, 3> kBeyondPx = {5, 8, 11};

enum class EndSeen { kOutside, kEnds, kGoesOn };

// Two of three places beyond the end with an edge are an edge that goes on.
EndSeen LookBeyond(const EdgeMap& map, const Vector2& end, const Vector2& direction) {
  int hits = 0;
  for (const float beyond : kBeyondPx) {
    const Vector2 p = end + beyond * direction;
    if (!map.Contains(p.x(), p.y())) return EndSeen::kOutside;
    hits += map.HasEdge(p.x(), p.y(), EdgeMap::Direction(direction.x(), direction.y())) ? 1 : 0;
  }
  return hits >= 2 ? EndSeen::kGoesOn : EndSeen::kEnds;
}

// What the image shows beyond both ends of an edge.
struct EdgeEnds {
  std::uint16_t edge = 0;
  std::array<EndSeen, 2> end{};
};

}  // namespace

Overrun MeasureOverrun(const RectifiedCamera& camera, const EdgeMap& left, const PreparedModel& model,
                       const Pose& T_camera_model, const EdgeBits& seen) {
  const ProjectedModel projected(camera, T_camera_model);
  FixedVector<EdgeEnds, kMaxModelEdges> edges;
  std::array<std::uint8_t, kMaxModelVertices> goes_on{};  // edges that go on beyond each vertex
  int ends = 0, overrun = 0;
  for (std::size_t e = NextEdge(seen, 0); e < model.edges.size(); e = NextEdge(seen, e + 1)) {
    const Vector2 a = projected.Pixel(model.edges[e].a), b = projected.Pixel(model.edges[e].b);
    const float length = (b - a).norm();
    if (length < kMinLengthPx) continue;
    const Vector2 direction = (b - a) / length;
    edges.push_back({static_cast<std::uint16_t>(e), {LookBeyond(left, a, -direction), LookBeyond(left, b, direction)}});
    for (std::size_t k = 0; k < 2; ++k) {
      if (edges.back().end[k] == EndSeen::kOutside) continue;
      ++ends;
      if (edges.back().end[k] != EndSeen::kGoesOn) continue;
      ++overrun;
      ++goes_on[model.view.edges[e].vertex[k]];
    }
  }
  int crossed = 0;
  for (const EdgeEnds& edge : edges) {
    const auto& vertex = model.view.edges[edge.edge].vertex;
    const auto others = [&](std::size_t k) { return goes_on[vertex[k]] - (edge.end[k] == EndSeen::kGoesOn ? 1 : 0); };
    crossed += others(0) > 0 && others(1) > 0 ? 1 : 0;
  }
  return {static_cast<float>(overrun) / static_cast<float>(std::max(ends, 4)),
          static_cast<float>(crossed) / static_cast<float>(std::max<std::size_t>(edges.size(), 4))};
}

}  // namespace wirepose
