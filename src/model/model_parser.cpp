#include "model/model_parser.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "model/crc32c.h"

namespace wirepose {
namespace {

static_assert(std::endian::native == std::endian::little,
              "records are read in place; a big-endian target needs a copy");
static_assert(sizeof(ModelFileHeader) % kModelAlignment == 0);

constexpr float kMaxExtent_m = 1000;       // beyond it the unit is wrong, and float loses a tenth of a millimetre
constexpr float kUnitTolerance = 1e-3F;    // of unit vectors and rotations
constexpr float kLengthTolerance = 1e-4F;  // of lengths, relative to the diameter: float rounding and no more
constexpr float kPi = 3.14159274F;

bool IsLength(float v) { return std::isfinite(v) && v >= 0 && v <= 2 * kMaxExtent_m; }

bool IsUnit(const float (&v)[3]) {
  const float squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];  // NaN and infinity fail the comparison
  return std::abs(squared - 1) <= kUnitTolerance;
}

bool NameIsGood(const char (&name)[kMaxModelName]) {
  for (std::size_t i = 0; i < kMaxModelName; ++i) {
    if (name[i] == 0) return i > 0;
    if (name[i] < ' ' || name[i] > '~') return false;
  }
  return false;
}

// Takes the sections in file order and remembers the first thing that is wrong with them.
class SectionReader {
 public:
  explicit SectionReader(std::span<const std::byte> file) : file_(file) {}

  template <typename Record>
  std::span<const Record> Take(const ModelSection& section, std::size_t capacity, bool may_be_empty) {
    static_assert(alignof(Record) <= kModelAlignment);
    if (error_) return {};
    if (section.count > capacity) return Fail<Record>(ModelError::kOverCapacity);
    if (section.count == 0 && !may_be_empty) return Fail<Record>(ModelError::kEmpty);
    const std::size_t size = section.count * sizeof(Record);  // cannot overflow: the count is within capacity
    if (section.offset % kModelAlignment != 0 || section.offset < end_ || section.offset > file_.size() ||
        size > file_.size() - section.offset) {
      return Fail<Record>(ModelError::kBadSection);
    }
    end_ = section.offset + size;
    return {reinterpret_cast<const Record*>(file_.data() + section.offset), section.count};
  }

  [[nodiscard]] bool failed() const { return error_; }
  [[nodiscard]] ModelError error() const { return reason_; }

 private:
  template <typename Record>
  std::span<const Record> Fail(ModelError reason) {
    error_ = true;
    reason_ = reason;
    return {};
  }

  std::span<const std::byte> file_;
  std::size_t end_ = sizeof(ModelFileHeader);
  bool error_ = false;
  ModelError reason_{};
};

bool DimensionsAreGood(const ModelView& m) {
  if (!IsLength(m.diameter_m) || m.diameter_m <= 0) return false;
  const float slack = kLengthTolerance * m.diameter_m;
  for (int i = 0; i < 3; ++i) {
    if (!(std::abs(m.box_min_m[i]) <= kMaxExtent_m && std::abs(m.box_max_m[i]) <= kMaxExtent_m)) return false;
    if (m.box_min_m[i] > m.box_max_m[i] || m.box_max_m[i] - m.box_min_m[i] > m.diameter_m + slack) return false;
  }
  return (m.box_max_m - m.box_min_m).norm() >= m.diameter_m - slack;
}

bool VerticesAreGood(const ModelView& m) {
  const float slack = kLengthTolerance * m.diameter_m;
  for (std::size_t i = 0; i < m.vertices.size(); ++i) {
    const Vector3 p = m.VertexPosition(i);
    for (int k = 0; k < 3; ++k) {
      if (!(p[k] >= m.box_min_m[k] - slack && p[k] <= m.box_max_m[k] + slack)) return false;
    }
  }
  return true;
}

bool TrianglesAreGood(const ModelView& m) {
  for (const ModelTriangle& t : m.triangles) {
    for (const std::uint16_t v : t.vertex) {
      if (v >= m.vertices.size()) return false;
    }
    if (t.vertex[0] == t.vertex[1] || t.vertex[1] == t.vertex[2] || t.vertex[2] == t.vertex[0]) return false;
    if (t.face >= m.faces.size()) return false;
  }
  return true;
}

// The faces' triangle ranges must follow one another and cover all triangles.
bool FacesAreGood(const ModelView& m) {
  std::size_t next_triangle = 0;
  for (std::size_t f = 0; f < m.faces.size(); ++f) {
    const ModelFace& face = m.faces[f];
    if (!IsUnit(face.normal) || !IsLength(std::abs(face.offset_m))) return false;
    if (!std::isfinite(face.area_m2) || face.area_m2 <= 0) return false;
    if (face.first_triangle != next_triangle || face.triangle_count == 0) return false;
    if (face.triangle_count > m.triangles.size() - next_triangle) return false;
    for (std::size_t t = 0; t < face.triangle_count; ++t) {
      if (m.triangles[next_triangle + t].face != f) return false;
    }
    next_triangle += face.triangle_count;
  }
  return next_triangle == m.triangles.size();
}

bool EdgeIsGood(const ModelView& m, const ModelEdge& e) {
  if (e.vertex[0] >= m.vertices.size() || e.vertex[1] >= m.vertices.size() || e.vertex[0] == e.vertex[1]) return false;
  if (e.face[0] >= m.faces.size() || (e.face[1] >= m.faces.size() && e.face[1] != kNoFace)) return false;
  if (e.face[0] == e.face[1] || e.convex > 1) return false;
  if (!IsLength(e.length_m) || e.length_m <= 0) return false;
  if (!(e.dihedral_rad >= 0 && e.dihedral_rad <= kPi)) return false;
  const float distance = (m.VertexPosition(e.vertex[1]) - m.VertexPosition(e.vertex[0])).norm();
  return std::abs(distance - e.length_m) <= kLengthTolerance * m.diameter_m;
}

bool EdgesAreGood(const ModelView& m) {
  for (std::size_t i = 0; i < m.edges.size(); ++i) {
    if (!EdgeIsGood(m, m.edges[i])) return false;
    if (i > 0 && m.edges[i].length_m > m.edges[i - 1].length_m) return false;
  }
  return true;
}

// Sets take consecutive ranges of the members, each of which belongs to one set.
bool LineSetsAreGood(const ModelView& m) {
  std::size_t next_member = 0;
  for (const ModelLineSet& s : m.line_sets) {
    const auto kind = static_cast<std::uint32_t>(s.kind);
    if (kind > static_cast<std::uint32_t>(LineSetKind::kIntersecting)) return false;
    if (s.base_edge >= m.edges.size() || s.face_count > m.faces.size()) return false;
    if (s.first_member != next_member || s.member_count == 0) return false;
    if (s.member_count > m.set_members.size() - next_member) return false;
    for (std::size_t k = 0; k < s.member_count; ++k) {
      if (m.set_members[next_member + k].edge == s.base_edge) return false;
    }
    next_member += s.member_count;
  }
  return next_member == m.set_members.size();
}

bool SetMembersAreGood(const ModelView& m) {
  for (const ModelSetMember& s : m.set_members) {
    if (s.edge >= m.edges.size() || s.common_faces > 2) return false;
    if (!(s.angle_rad >= 0 && s.angle_rad <= kPi / 2 + kUnitTolerance)) return false;
    if (!IsLength(s.distance_m) || !IsLength(s.nearest_end_m) || !IsLength(s.farthest_end_m)) return false;
    if (s.nearest_end_m > s.farthest_end_m) return false;
  }
  return true;
}

bool SymmetriesAreGood(const ModelView& m) {
  for (const ModelSymmetry& s : m.symmetries) {
    Matrix3 R;
    for (int i = 0; i < 9; ++i) {
      if (!(std::abs(s.rotation[i]) <= 1 + kUnitTolerance)) return false;
      R(i / 3, i % 3) = s.rotation[i];
    }
    if ((R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() > kUnitTolerance) return false;
    if (!(R.determinant() > 0)) return false;
    for (const float t : s.translation_m) {
      if (!IsLength(std::abs(t) / 2)) return false;  // at most twice the distance of the centre from the origin
    }
  }
  return true;
}

bool AspectsAreGood(const ModelView& m) {
  for (const ModelAspect& a : m.aspects) {
    if (!IsUnit(a.direction) || !std::isfinite(a.distance_m) || a.distance_m <= 0) return false;
    for (std::size_t e = m.edges.size(); e < kMaxModelEdges; ++e) {
      if ((a.visible_edges[e / 32] >> (e % 32) & 1U) != 0) return false;
    }
  }
  return true;
}

struct ContentCheck {
  bool (*passes)(const ModelView&);
  ModelError error;
};

// In this order, because later checks rely on earlier ones.
constexpr ContentCheck kContentChecks[] = {
    {DimensionsAreGood, ModelError::kBadDimensions},
    {VerticesAreGood, ModelError::kBadVertex},
    {TrianglesAreGood, ModelError::kBadTriangle},
    {FacesAreGood, ModelError::kBadFace},
    {EdgesAreGood, ModelError::kBadEdge},
    {LineSetsAreGood, ModelError::kBadLineSet},
    {SetMembersAreGood, ModelError::kBadSetMember},
    {SymmetriesAreGood, ModelError::kBadSymmetry},
    {AspectsAreGood, ModelError::kBadAspect},
};

Result<void, ModelError> CheckEnvelope(std::span<const std::byte> file, const ModelFileHeader& header) {
  if (header.magic != kModelMagic) return unexpected(ModelError::kNotAModel);
  if (header.version != kModelVersion) return unexpected(ModelError::kWrongVersion);
  if (header.file_size != file.size()) return unexpected(ModelError::kWrongSize);
  constexpr std::size_t kAfterCrc = offsetof(ModelFileHeader, crc32c) + sizeof(header.crc32c);
  if (Crc32c(file.subspan(kAfterCrc)) != header.crc32c) return unexpected(ModelError::kDamaged);
  if (!NameIsGood(header.name)) return unexpected(ModelError::kBadName);
  return {};
}

Result<ModelView, ModelError> TakeSections(std::span<const std::byte> file, const ModelFileHeader& h) {
  SectionReader reader(file);
  ModelView m;
  m.vertices = reader.Take<ModelVertex>(h.vertices, kMaxModelVertices, false);
  m.triangles = reader.Take<ModelTriangle>(h.triangles, kMaxModelTriangles, false);
  m.faces = reader.Take<ModelFace>(h.faces, kMaxModelFaces, false);
  m.edges = reader.Take<ModelEdge>(h.edges, kMaxModelEdges, false);
  m.line_sets = reader.Take<ModelLineSet>(h.line_sets, kMaxModelLineSets, true);
  m.set_members = reader.Take<ModelSetMember>(h.set_members, kMaxModelSetMembers, true);
  m.symmetries = reader.Take<ModelSymmetry>(h.symmetries, kMaxModelSymmetries - 1, true);
  m.aspects = reader.Take<ModelAspect>(h.aspects, kMaxModelAspects, true);
  if (reader.failed()) return unexpected(reader.error());
  return m;
}

}  // namespace

Result<ModelView, ModelError> ParseModel(std::span<const std::byte> file) {
  if (reinterpret_cast<std::uintptr_t>(file.data()) % kModelAlignment != 0) return unexpected(ModelError::kMisaligned);
  if (file.size() < sizeof(ModelFileHeader)) return unexpected(ModelError::kTooShort);
  const auto& header = *reinterpret_cast<const ModelFileHeader*>(file.data());
  if (const auto envelope = CheckEnvelope(file, header); !envelope) return unexpected(envelope.error());

  auto model = TakeSections(file, header);
  if (!model) return model;
  model->id = header.id;
  model->checksum = header.crc32c;
  model->name = header.name;
  model->diameter_m = header.diameter_m;
  model->box_min_m = Vector3(header.box_min_m);
  model->box_max_m = Vector3(header.box_max_m);
  for (const ContentCheck& check : kContentChecks) {
    if (!check.passes(*model)) return unexpected(check.error);
  }
  return model;
}

const char* Describe(ModelError error) {
  switch (error) {
    case ModelError::kMisaligned:
      return "model bytes do not start at a multiple of 8; align the buffer";
    case ModelError::kTooShort:
      return "too short for a model file; copy it again or rebuild it with `wirepose model build`";
    case ModelError::kNotAModel:
      return "not a model file (.wpm); build one from a mesh with `wirepose model build`";
    case ModelError::kWrongVersion:
      return "model file of another format version; rebuild it with `wirepose model build`";
    case ModelError::kWrongSize:
      return "model file is truncated or has trailing bytes; copy it again or rebuild it";
    case ModelError::kDamaged:
      return "model file is damaged (CRC-32C does not match); copy it again or rebuild it";
    case ModelError::kBadName:
      return "model name is empty, not terminated or not printable ASCII; rebuild with --name";
    case ModelError::kBadSection:
      return "model file's section table is inconsistent; rebuild it from the mesh";
    case ModelError::kOverCapacity:
      return "model is larger than this build's capacities; rebuild it from a simpler mesh";
    case ModelError::kEmpty:
      return "model has no vertices, triangles, faces or edges; rebuild it from a mesh with "
             "creases";
    case ModelError::kBadDimensions:
      return "model's diameter or bounding box is invalid; rebuild it from the mesh";
    case ModelError::kBadVertex:
      return "model vertex is not finite or outside the bounding box; rebuild it from the mesh";
    case ModelError::kBadTriangle:
      return "model triangle has an index out of range; rebuild it from the mesh";
    case ModelError::kBadFace:
      return "model face is invalid (normal, area or triangle range); rebuild it from the mesh";
    case ModelError::kBadEdge:
      return "model edge is invalid (index, length or order); rebuild it from the mesh";
    case ModelError::kBadLineSet:
      return "model line set is invalid (kind, index or member range); rebuild it from the mesh";
    case ModelError::kBadSetMember:
      return "line set member is invalid (index or parameter vector); rebuild it from the mesh";
    case ModelError::kBadSymmetry:
      return "model symmetry is not a rigid motion; rebuild it from the mesh";
    case ModelError::kBadAspect:
      return "model aspect is invalid (direction or visibility bits); rebuild it from the mesh";
  }
  return "?";
}

}  // namespace wirepose
