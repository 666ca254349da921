#include "tools/model_compiler/mesh_reader.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <system_error>

namespace wirepose::tools {
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
    mesh.triangles.push_back({first + static_cast<int>(face.mIndices[0]),
                              first + static_cast<int>(face.mIndices[1]),
                              first + static_cast<int>(face.mIndices[2])});
  }
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

  Assimp::Importer importer;
  const aiScene* scene =
      importer.ReadFile(name, aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (scene == nullptr) {
    return unexpected(name + ": cannot be read as a mesh (" + OneLine(importer.GetErrorString()) +
                      "); export it as PLY, OBJ or STL");
  }
  Mesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    Append(*scene->mMeshes[i], metres_per_unit, mesh);
  if (mesh.triangles.empty())
    return unexpected(name + ": has no faces; export the object as a surface mesh");
  return mesh;
}

}  // namespace wirepose::tools
