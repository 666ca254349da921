#include "tools/model_compiler/model_compiler.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "mesh/mesh_reader.h"
#include "model/model_parser.h"
#include "tools/model_compiler/aspects.h"
#include "tools/model_compiler/line_geometry.h"
#include "tools/model_compiler/line_sets.h"
#include "tools/model_compiler/mesh_cleaning.h"
#include "tools/model_compiler/model_writer.h"
#include "tools/model_compiler/symmetry.h"

namespace wirepose::tools {
namespace {

using Eigen::Vector3d;

// Relative to the diameter.
constexpr double kWeldTolerance = 1e-4;   // nearer vertices are one; exporters round to about 1e-6
constexpr double kPlaneTolerance = 1e-3;  // of a face, and of collinear pieces of an edge
constexpr double kSymmetryTolerance = 2e-3;
constexpr double kOcclusionTolerance = 1e-3;  // a surface nearer than this before an edge does not hide it

constexpr double kFaceAngle_rad = 1.0 * M_PI / 180;      // between a triangle and its face, first attempt
constexpr double kMaxFaceAngle_rad = 12.0 * M_PI / 180;  // and the coarsest: well below the crease angle
constexpr double kSmallestPlausible_m = 0.005, kLargestPlausible_m = 10;

using Notes = std::vector<std::string>;

struct Wireframe {
  mesh::Mesh mesh;
  double diameter = 0;
  std::vector<Face> faces;
  std::vector<int> face_of_triangle;
  std::vector<Crease> creases;
  std::vector<Aspect> aspects;
};

std::string Count(std::size_t n, const char* what) { return std::to_string(n) + " " + what; }

Result<void, std::string> CheckName(const std::string& name) {
  const bool printable = std::all_of(name.begin(), name.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (!name.empty() && name.size() < kMaxModelName && printable) return {};
  return unexpected("the name '" + name + "' is not 1 to " + std::to_string(kMaxModelName - 1) +
                    " printable ASCII characters; choose another (--name)");
}

// Repairs the mesh until faces and edges can be read off it.
Result<void, std::string> CleanMesh(Wireframe& w, Notes& notes) {
  for (const Vector3d& v : w.mesh.vertices) {
    if (!v.allFinite() || v.cwiseAbs().maxCoeff() > 1e6) {
      return unexpected(std::string("a vertex is not finite or absurdly far away; export the mesh again"));
    }
  }
  const double tolerance = kWeldTolerance * BoxDiagonal(w.mesh);
  if (!(tolerance > 0)) return unexpected(std::string("the mesh has no extent; export the object as a surface mesh"));
  if (const auto n = Weld(tolerance, w.mesh); n > 0)
    notes.push_back("dropped " + Count(n, "degenerate or repeated triangles"));
  if (w.mesh.triangles.empty()) {
    return unexpected(std::string("all triangles are degenerate; export the object as a surface mesh"));
  }
  if (w.mesh.triangles.size() > kMaxModelTriangles || w.mesh.vertices.size() > kMaxModelVertices) {
    return unexpected(Count(w.mesh.triangles.size(), "triangles and ") +
                      Count(w.mesh.vertices.size(), "vertices, of at most ") + std::to_string(kMaxModelTriangles) +
                      " and " + std::to_string(kMaxModelVertices) +
                      "; simplify the mesh (for example MeshLab, quadric edge collapse) or leave "
                      "out small parts");
  }
  if (const auto n = SplitAtTJunctions(tolerance, w.mesh); n > 0) notes.push_back("closed " + Count(n, "T-junctions"));
  if (w.mesh.triangles.size() > kMaxModelTriangles) {
    return unexpected(Count(w.mesh.triangles.size(), "triangles after closing T-junctions, of at most ") +
                      std::to_string(kMaxModelTriangles) + "; export a mesh in which neighbours share their vertices");
  }
  if (const auto n = OrientOutward(w.mesh); n > 0) notes.push_back("turned " + Count(n, "triangles outward"));
  w.diameter = Diameter(w.mesh);
  return {};
}

void JudgeSize(double diameter, Notes& notes) {
  if (diameter >= kSmallestPlausible_m && diameter <= kLargestPlausible_m) return;
  char text[160];
  std::snprintf(text, sizeof text, "warning: the object is %.4g m large; is the mesh in %s? choose with --unit",
                diameter, diameter < kSmallestPlausible_m ? "metres" : "millimetres");
  notes.emplace_back(text);
}

// Merges faces; a finely tessellated object that has too many is merged more coarsely, up to a
// limit.
Result<void, std::string> MergeFaces(Wireframe& w, Notes& notes) {
  for (double angle = kFaceAngle_rad; angle <= kMaxFaceAngle_rad; angle *= 1.5) {
    const double coarseness = angle / kFaceAngle_rad;
    w.faces = MergeCoplanar(w.mesh, {angle, coarseness * kPlaneTolerance * w.diameter}, w.face_of_triangle);
    if (w.faces.size() > kMaxModelFaces) continue;
    if (coarseness > 1) notes.emplace_back("curved surfaces were merged into coarse planes to fit the face capacity");
    return {};
  }
  return unexpected(Count(w.faces.size(), "planar faces, of at most ") + std::to_string(kMaxModelFaces) +
                    "; simplify the mesh or tessellate curved surfaces more coarsely");
}

// Keeps the longest creases of those that can be seen at all.
void KeepVisibleCreases(Wireframe& w, Notes& notes) {
  std::vector<std::size_t> kept;
  std::size_t hidden = 0;
  for (std::size_t e = 0; e < w.creases.size(); ++e) {
    const bool seen =
        std::any_of(w.aspects.begin(), w.aspects.end(), [&](const Aspect& a) { return a.visible_samples[e] > 0; });
    hidden += seen ? 0 : 1;
    if (seen) kept.push_back(e);
  }
  if (hidden > 0) notes.push_back("left out " + Count(hidden, "edges that are visible from nowhere"));
  if (kept.size() > kMaxModelEdges) {
    notes.push_back("warning: kept the longest " + std::to_string(kMaxModelEdges) + " of " +
                    Count(kept.size(), "edges"));
    kept.resize(kMaxModelEdges);
  }
  std::vector<Crease> creases;
  for (const std::size_t e : kept) creases.push_back(w.creases[e]);
  for (Aspect& a : w.aspects) {
    std::vector<int> samples;
    for (const std::size_t e : kept) samples.push_back(a.visible_samples[e]);
    a.visible_samples = std::move(samples);
  }
  w.creases = std::move(creases);
}

std::vector<std::vector<bool>> CoVisibility(const Wireframe& w) {
  const std::size_t n = w.creases.size();
  std::vector<std::vector<bool>> together(n, std::vector<bool>(n, false));
  for (const Aspect& a : w.aspects) {
    for (std::size_t i = 0; i < n; ++i) {
      if (2 * a.visible_samples[i] < kSamplesPerEdge) continue;
      for (std::size_t j = 0; j < n; ++j) {
        if (2 * a.visible_samples[j] >= kSamplesPerEdge) together[i][j] = true;
      }
    }
  }
  return together;
}

void StoreMesh(const Wireframe& w, ModelRecords& records) {
  for (const Vector3d& v : w.mesh.vertices) {
    records.vertices.push_back({static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())});
  }
  for (std::size_t f = 0; f < w.faces.size(); ++f) {
    const Face& face = w.faces[f];
    const Eigen::Vector3f n = face.normal.cast<float>();
    records.faces.push_back({{n.x(), n.y(), n.z()},
                             static_cast<float>(face.normal.dot(face.centroid)),
                             static_cast<float>(face.area),
                             static_cast<std::uint16_t>(records.triangles.size()),
                             static_cast<std::uint16_t>(face.triangles.size())});
    for (const int t : face.triangles) {
      const auto& v = w.mesh.triangles[t];
      records.triangles.push_back(
          {{static_cast<std::uint16_t>(v[0]), static_cast<std::uint16_t>(v[1]), static_cast<std::uint16_t>(v[2])},
           static_cast<std::uint16_t>(f)});
    }
  }
}

void StoreEdges(const Wireframe& w, ModelRecords& records) {
  for (const Crease& c : w.creases) {
    const auto second_face = c.face[1] == kOpen ? kNoFace : static_cast<std::uint16_t>(c.face[1]);
    records.edges.push_back({{static_cast<std::uint16_t>(c.vertex[0]), static_cast<std::uint16_t>(c.vertex[1])},
                             {static_cast<std::uint16_t>(c.face[0]), second_face},
                             static_cast<float>(c.length),
                             static_cast<float>(c.dihedral),
                             c.convex ? 1U : 0U});
  }
  for (const Aspect& a : w.aspects) {
    ModelAspect aspect{};
    for (int k = 0; k < 3; ++k) aspect.direction[k] = static_cast<float>(a.direction[k]);
    aspect.distance_m = static_cast<float>(a.distance);
    for (std::size_t e = 0; e < w.creases.size(); ++e) {
      if (2 * a.visible_samples[e] >= kSamplesPerEdge) aspect.visible_edges[e / 32] |= 1U << (e % 32);
    }
    records.aspects.push_back(aspect);
  }
}

void StoreSymmetries(const Symmetries& symmetries, ModelRecords& records) {
  for (const Pose& pose : symmetries.poses) {
    ModelSymmetry s{};
    for (int i = 0; i < 9; ++i) s.rotation[i] = static_cast<float>(pose.R(i / 3, i % 3));
    for (int k = 0; k < 3; ++k) s.translation_m[k] = static_cast<float>(pose.t[k]);
    records.symmetries.push_back(s);
  }
}

void StoreBox(const Wireframe& w, ModelRecords& records) {
  records.diameter_m = static_cast<float>(w.diameter);
  for (int k = 0; k < 3; ++k) {
    const auto less = [k](const Vector3d& a, const Vector3d& b) { return a[k] < b[k]; };
    const auto [low, high] = std::minmax_element(w.mesh.vertices.begin(), w.mesh.vertices.end(), less);
    records.box_min_m[k] = static_cast<float>((*low)[k]);
    records.box_max_m[k] = static_cast<float>((*high)[k]);
  }
}

Result<std::vector<std::byte>, std::string> ReadBytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return unexpected(file.string() + ": cannot be opened; check path and permissions");
  const std::vector<char> text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::vector<std::byte> bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

}  // namespace

Result<CompiledModel, std::string> CompileModel(const mesh::Mesh& mesh, const CompileOptions& options) {
  if (const auto ok = CheckName(options.name); !ok) return unexpected(ok.error());
  CompiledModel model;
  Wireframe w;
  w.mesh = mesh;
  if (const auto ok = CleanMesh(w, model.notes); !ok) return unexpected(ok.error());
  JudgeSize(w.diameter, model.notes);
  if (const auto ok = MergeFaces(w, model.notes); !ok) return unexpected(ok.error());
  w.creases = FindCreases(w.mesh, w.faces, w.face_of_triangle, options.crease_angle_rad, kPlaneTolerance * w.diameter);
  const Symmetries symmetries =
      FindSymmetries(w.mesh, w.faces, w.creases, kSymmetryTolerance * w.diameter, kMaxModelSymmetries - 1);
  if (symmetries.found > symmetries.poses.size()) {
    model.notes.push_back("kept " + std::to_string(symmetries.poses.size()) + " of " +
                          Count(symmetries.found, "symmetries"));
  }
  w.aspects = TraceAspects(w.mesh, w.faces, w.creases, w.diameter, kOcclusionTolerance * w.diameter);
  KeepVisibleCreases(w, model.notes);
  if (w.creases.empty()) {
    return unexpected(
        std::string("no crease edges: the object is smooth all over and has no lines to be recognized by"));
  }

  ModelRecords records;
  records.id = options.id;
  records.name = options.name;
  StoreBox(w, records);
  StoreMesh(w, records);
  StoreEdges(w, records);
  StoreSymmetries(symmetries, records);
  LineSets sets = MakeLineSets(w.mesh, w.creases, CoVisibility(w), options.parallel_angle_rad);
  records.line_sets = std::move(sets.sets);
  records.set_members = std::move(sets.members);
  model.bytes = WriteModel(records);
  if (const auto view = ParseModel(model.bytes); !view) return unexpected(std::string(Describe(view.error())));
  return model;
}

Result<CompiledModel, std::string> CompileModel(const std::filesystem::path& mesh_file, const CompileOptions& options) {
  const auto mesh = mesh::ReadMesh(mesh_file, options.unit == MeshUnit::kMetre ? 1.0 : 1e-3);
  if (!mesh) return unexpected(mesh.error());
  CompileOptions named = options;
  if (named.name.empty()) named.name = mesh_file.stem().string();
  auto model = CompileModel(*mesh, named);
  if (!model) return unexpected(mesh_file.string() + ": " + model.error());
  return model;
}

ModelView CompiledModel::View() const { return ParseModel(bytes).value(); }

Result<CompiledModel, std::string> ReadModelFile(const std::filesystem::path& file) {
  auto bytes = ReadBytes(file);
  if (!bytes) return unexpected(bytes.error());
  if (const auto view = ParseModel(*bytes); !view) return unexpected(file.string() + ": " + Describe(view.error()));
  return CompiledModel{std::move(*bytes), {}};
}

Result<void, std::string> WriteModelFile(const std::filesystem::path& file, const CompiledModel& model) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(model.bytes.data()), static_cast<std::streamsize>(model.bytes.size()));
  out.close();
  if (!out) return unexpected(file.string() + ": cannot be written; check that the folder exists and is writable");
  return {};
}

}  // namespace wirepose::tools
