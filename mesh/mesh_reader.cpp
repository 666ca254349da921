#include "mesh/mesh_reader.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <fstream>
#include <sstream>
#include <system_error>

#include "mesh/ply_reader.h"

namespace wirepose::mesh {
namespace {

std::string OneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

void Append(const aiMesh& part, double scale, Mesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& v = part.mVertices[i];
    mesh.vertices.emplace_back(scale * static_cast<double>(v.x), scale * static_cast<double>(v.y),
                               scale * static_cast<double>(v.z));
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;  // loose points and lines
    mesh.triangles.push_back({first + static_cast<int>(face.mIndices[0]), first + static_cast<int>(face.mIndices[1]),
                              first + static_cast<int>(face.mIndices[2])});
  }
}

Result<Mesh, std::string> ReadPly(const std::filesystem::path& file, double metres_per_unit) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return unexpected(std::string("cannot be opened; check the permissions"));
  std::ostringstream text;
  text << in.rdbuf();
  return ParsePly(text.str(), metres_per_unit);
}

Result<Mesh, std::string> ReadWithAssimp(const std::filesystem::path& file, double metres_per_unit) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (scene == nullptr) {
    return unexpected("cannot be read as a mesh (" + OneLine(importer.GetErrorString()) +
                      "); export it as PLY, OBJ or STL");
  }
  Mesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) Append(*scene->mMeshes[i], metres_per_unit, mesh);
  return mesh;
}

bool IsPly(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return extension == ".ply";
}

}  // namespace

Result<Mesh, std::string> ReadMesh(const std::filesystem::path& file, double metres_per_unit) {
  const std::string name = file.string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return unexpected(name + ": no such file; give a mesh file (PLY, OBJ, STL)");
  }
  if (std::filesystem::file_size(file, error) == 0)
    return unexpected(name + ": the file is empty; export the mesh again");
  auto mesh = IsPly(file) ? ReadPly(file, metres_per_unit) : ReadWithAssimp(file, metres_per_unit);
  if (!mesh) return unexpected(name + ": " + mesh.error());
  if (mesh->triangles.empty()) return unexpected(name + ": has no faces; export the object as a surface mesh");
  return mesh;
}

}  // namespace wirepose::mesh
