// A line model as the recognizer reads it: spans into a model file that somebody else owns.
#ifndef WIREPOSE_MODEL_MODEL_VIEW_H_
#define WIREPOSE_MODEL_MODEL_VIEW_H_

#include <array>
#include <span>
#include <string_view>

#include "geometry/se3.h"
#include "model/model_format.h"

namespace wirepose {

// Read-only and in place; the bytes it was parsed from must stay unchanged for as long as it is used. A view that
// ParseModel returned is consistent: every index is in range, every count within capacity, every number finite.
struct ModelView {
  std::uint32_t id = 0;
  std::uint32_t checksum = 0;  // the file's CRC-32C: names the very model in health messages
  std::string_view name;
  float diameter_m = 0;
  Vector3 box_min_m = Vector3::Zero();
  Vector3 box_max_m = Vector3::Zero();
  std::span<const ModelVertex> vertices;
  std::span<const ModelTriangle> triangles;
  std::span<const ModelFace> faces;
  std::span<const ModelEdge> edges;  // by falling length
  std::span<const ModelLineSet> line_sets;
  std::span<const ModelSetMember> set_members;
  std::span<const ModelSymmetry> symmetries;  // without the identity
  std::span<const ModelAspect> aspects;

  [[nodiscard]] Vector3 VertexPosition(std::size_t i) const { return {vertices[i].x, vertices[i].y, vertices[i].z}; }
};

// True when the face turns towards an observer at `eye` (model frame, m).
inline bool IsTowards(const ModelFace& face, const Vector3& eye) {
  return Vector3(face.normal[0], face.normal[1], face.normal[2]).dot(eye) > face.offset_m;
}

// The faces that turn towards an observer at `eye` (model frame, m). O(faces).
class FacesTowards {
 public:
  FacesTowards(const ModelView& model, const Vector3& eye) {
    for (std::size_t f = 0; f < model.faces.size(); ++f) towards_[f] = IsTowards(model.faces[f], eye);
  }
  [[nodiscard]] bool Has(std::uint16_t face) const { return face != kNoFace && towards_[face]; }
  // The background begins behind an edge of which no more than one face turns towards the observer.
  [[nodiscard]] bool IsOutline(const ModelEdge& edge) const { return !(Has(edge.face[0]) && Has(edge.face[1])); }

 private:
  std::array<bool, kMaxModelFaces> towards_{};
};

}  // namespace wirepose

#endif  // WIREPOSE_MODEL_MODEL_VIEW_H_
