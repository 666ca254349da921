#include "sim/target_mesh.h"

#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>

#include "hal/dataset/dataset.h"
#include "sim/edge_truth.h"

namespace wirepose::sim {
namespace {

namespace fs = std::filesystem;

// PLY before OBJ before STL; -1 for what is no mesh.
int FormatRank(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::vector<std::string> known = {".ply", ".obj", ".stl"};
  const auto found = std::find(known.begin(), known.end(), extension);
  return found == known.end() ? -1 : static_cast<int>(found - known.begin());
}

// The id that a name stands for; 0 when it has none of its own.
int OwnId(const std::string& name) {
  const std::map<std::string, int> known = {
      {"parcel_box", 1}, {"book", 2}, {"juice_dispenser", 3}, {"refrigerator", 4}};
  if (const auto found = known.find(name); found != known.end()) return found->second;
  if (name.rfind("obj_", 0) != 0) return 0;
  int id = 0;
  const char* end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data() + 4, end, id);
  return error == std::errc() && stop == end && id > 0 ? id : 0;
}

// One file a name, in alphabetical order.
std::map<std::string, fs::path> MeshFiles(const fs::path& folder, std::error_code& error) {
  std::map<std::string, fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const int rank = FormatRank(entry.path());
    if (rank < 0) continue;
    fs::path& file = files[entry.path().stem().string()];
    if (file.empty() || rank < FormatRank(file)) file = entry.path();
  }
  return files;
}

double Diameter(const Mesh& mesh) {
  double squared = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      squared = std::max(squared, (mesh.vertices[i] - mesh.vertices[j]).cast<double>().squaredNorm());
    }
  }
  return std::sqrt(squared);
}

nlohmann::ordered_json ModelInfo(const Mesh& mesh) {
  const Vector3d low = 1000 * mesh.Min().cast<double>();
  const Vector3d size = 1000 * (mesh.Max() - mesh.Min()).cast<double>();
  nlohmann::ordered_json info = {{"diameter", 1000 * Diameter(mesh)},
                                 {"min_x", low.x()},
                                 {"min_y", low.y()},
                                 {"min_z", low.z()},
                                 {"size_x", size.x()},
                                 {"size_y", size.y()},
                                 {"size_z", size.z()}};
  for (const Pose& symmetry : BoxSymmetries(mesh)) {
    nlohmann::ordered_json matrix = nlohmann::ordered_json::array();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) matrix.push_back(symmetry.R(row, column));
      matrix.push_back(1000 * symmetry.t[row]);
    }
    for (const double value : {0.0, 0.0, 0.0, 1.0}) matrix.push_back(value);
    info["symmetries_discrete"].push_back(matrix);
  }
  return info;
}

// [x, y, z, x, y, z] of both ends of each sharp edge, mm.
nlohmann::ordered_json ModelEdges(const Mesh& mesh) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [a, b] : SharpEdges(mesh)) {
    list.push_back({1000 * a.x(), 1000 * a.y(), 1000 * a.z(), 1000 * b.x(), 1000 * b.y(), 1000 * b.z()});
  }
  return list;
}

bool WritePly(const fs::path& path, const TargetMesh& target) {
  std::ofstream out(path, std::ios::binary);
  out << "ply\nformat ascii 1.0\ncomment " << target.name << ", units mm\nelement vertex "
      << target.mesh.vertices.size() << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
      << target.mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  char line[96];
  for (const Vector3& vertex : target.mesh.vertices) {
    const Vector3d mm = 1000 * vertex.cast<double>();
    std::snprintf(line, sizeof line, "%.6g %.6g %.6g\n", mm.x(), mm.y(), mm.z());
    out << line;
  }
  for (const auto& t : target.mesh.triangles) {
    out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  }
  return bool{out.flush()};
}

// The 24 rotations that map axes to axes.
std::vector<Matrix3d> QuarterTurns() {
  std::vector<Matrix3d> turns;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3d R = Matrix3d::Zero();
      for (int i = 0; i < 3; ++i) {
        R(i, order[static_cast<std::size_t>(i)]) = (signs >> i & 1) != 0 ? -1 : 1;
      }
      if (R.determinant() > 0) turns.push_back(R);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return turns;
}

bool MapsOntoItself(const Mesh& mesh, const Pose& T, double tolerance) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [&](const Vector3& vertex) {
    const Vector3d image = T * vertex.cast<double>();
    return std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                       [&](const Vector3& other) { return (other.cast<double>() - image).norm() < tolerance; });
  });
}

}  // namespace

Result<std::vector<TargetMesh>, std::string> LoadTargetMeshes(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return unexpected(folder.string() + ": no such folder of meshes; check the path");
  }
  const std::map<std::string, fs::path> files = MeshFiles(folder, error);
  if (error) return unexpected(folder.string() + ": cannot be listed: " + error.message());
  if (files.empty()) {
    return unexpected(folder.string() + ": no mesh (.ply, .obj, .stl) in it; choose another folder");
  }
  std::map<int, TargetMesh> by_id;
  int greatest = 4;  // ids of the project's own models stay theirs
  for (const auto& [name, path] : files) greatest = std::max(greatest, OwnId(name));
  for (const auto& [name, path] : files) {
    Result<Mesh, std::string> mesh = LoadMesh(path);
    if (!mesh) return unexpected(mesh.error());
    const int id = OwnId(name) != 0 ? OwnId(name) : ++greatest;
    if (!by_id.emplace(id, TargetMesh{id, name, path, *std::move(mesh)}).second) {
      return unexpected(path.string() + ": object id " + std::to_string(id) + " is taken by another file; rename one");
    }
  }
  std::vector<TargetMesh> targets;
  for (auto& [id, target] : by_id) targets.push_back(std::move(target));
  return targets;
}

std::vector<Pose> BoxSymmetries(const Mesh& mesh) {
  const Vector3d centre = 0.5 * (mesh.Min() + mesh.Max()).cast<double>();
  const double tolerance = 1e-3 * Diameter(mesh);
  std::vector<Pose> symmetries;
  for (const Matrix3d& R : QuarterTurns()) {
    const Pose T{R, centre - R * centre};
    if (!R.isIdentity() && MapsOntoItself(mesh, T, tolerance)) symmetries.push_back(T);
  }
  return symmetries;
}

Result<void, std::string> WriteTargetMeshes(const fs::path& root, const std::vector<TargetMesh>& targets) {
  const auto failed = [](const fs::path& path) {
    return unexpected(path.string() + ": cannot be written; check folder, permissions and free space");
  };
  nlohmann::ordered_json infos;
  for (const TargetMesh& target : targets) {
    const fs::path path = dataset::ModelPath(root, target.obj_id);
    if (!WritePly(path, target)) return failed(path);
    infos[std::to_string(target.obj_id)] = ModelInfo(target.mesh);
  }
  nlohmann::ordered_json edges;
  for (const TargetMesh& target : targets) edges[std::to_string(target.obj_id)] = ModelEdges(target.mesh);
  const fs::path info_path = root / "models" / "models_info.json", edges_path = root / "models" / "model_edges.json";
  std::ofstream info_out(info_path, std::ios::binary), edges_out(edges_path, std::ios::binary);
  if (!(info_out << infos.dump(1) << "\n") || !info_out.flush()) return failed(info_path);
  if (!(edges_out << edges.dump() << "\n") || !edges_out.flush()) return failed(edges_path);
  return {};
}

}  // namespace wirepose::sim
