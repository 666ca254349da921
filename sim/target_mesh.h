// The objects to be recognized, from a folder of meshes.
#ifndef WIREPOSE_SIM_TARGET_MESH_H_
#define WIREPOSE_SIM_TARGET_MESH_H_

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/mesh.h"

namespace wirepose::sim {

struct TargetMesh {
  int obj_id = 0;
  std::string name;            // the file's name without extension
  std::filesystem::path path;  // empty: made, not loaded
  Mesh mesh;
};

// Loads every PLY, OBJ and STL file of the folder (units: mm), by obj_id. obj_00000N is object N;
// the project's own models parcel_box, book, juice_dispenser and refrigerator are 1 to 4; further
// files count on from the greatest id in alphabetical order. One name in two formats is read once,
// PLY before OBJ before STL. The error is one line.
[[nodiscard]] Result<std::vector<TargetMesh>, std::string> LoadTargetMeshes(const std::filesystem::path& folder);

// Writes ROOT/models as BOP has it, and model_edges.json, which scene_edges_cam{1,2}.json refer to:
// obj_00000N.ply (ASCII, mm) and models_info.json with diameter,
// bounding box and the symmetries_discrete among the rotations by quarter turns about the axes of
// the bounding box.
[[nodiscard]] Result<void, std::string> WriteTargetMeshes(const std::filesystem::path& root,
                                                          const std::vector<TargetMesh>& targets);

// Rotations (about the centre of the bounding box, identity left out) that map the mesh's vertices
// onto its vertices within 0.1 % of its diameter. Only quarter turns about the coordinate axes are
// tried. O(vertices^2).
[[nodiscard]] std::vector<Pose> BoxSymmetries(const Mesh& mesh);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_TARGET_MESH_H_
