// The model file (.wpm): plain records, little-endian, usable in place from flash.
//
// Layout: ModelFileHeader, then the sections in the order of its table, each 8-byte aligned. The CRC-32C covers every
// byte after the header's `crc32c` field. All lengths are metres, all angles radians, all indices count from 0.
#ifndef WIREPOSE_MODEL_MODEL_FORMAT_H_
#define WIREPOSE_MODEL_MODEL_FORMAT_H_

#include <array>
#include <cstdint>

#include "capacities.h"

namespace wirepose {

inline constexpr std::uint32_t kModelMagic = 0x314D5057;  // "WPM1"
inline constexpr std::uint32_t kModelVersion = 1;
inline constexpr std::uint16_t kNoFace = 0xFFFF;  // second face of a boundary edge of an open mesh

struct ModelVertex {
  float x, y, z;  // m, model frame
};

// Counter-clockwise seen from outside.
struct ModelTriangle {
  std::uint16_t vertex[3];
  std::uint16_t face;
};

// A planar surface: all points with normal . p = offset. Its triangles are consecutive.
struct ModelFace {
  float normal[3];  // unit, outward
  float offset_m;
  float area_m2;
  std::uint16_t first_triangle;
  std::uint16_t triangle_count;
};

// A straight crease between two faces. Edges are sorted by falling length.
struct ModelEdge {
  std::uint16_t vertex[2];
  std::uint16_t face[2];  // kNoFace where the mesh is open
  float length_m;
  float dihedral_rad;    // angle between the outward normals: 0 flat, > 0; see `convex`
  std::uint32_t convex;  // 1: a ridge, 0: a valley
};

enum class LineSetKind : std::uint32_t { kParallel = 0, kIntersecting = 1 };

// A line set of the paper (section 3.1): the base line and the lines related to it by position and orientation.
struct ModelLineSet {
  LineSetKind kind;
  std::uint16_t base_edge;
  std::uint16_t face_count;  // surfaces that base and members touch: the paper ranks by it
  std::uint32_t first_member;
  std::uint32_t member_count;
};

// One line of a set with its share of the parameter vector V (paper eq. 1-7) relative to the base line.
struct ModelSetMember {
  std::uint16_t edge;
  std::uint16_t common_faces;  // faces that touch both base and member: 0, 1 or 2
  float angle_rad;             // delta_phi of a parallel, phi of an intersecting line; 0..pi/2
  float distance_m;            // lambda: between the two infinite lines
  float nearest_end_m;         // delta_d: shortest distance between end points
  float farthest_end_m;        // rho or theta: longest distance between end points
};

// A rigid motion that maps the model onto itself: p -> R p + t.
struct ModelSymmetry {
  float rotation[9];  // row-major
  float translation_m[3];
};

// What can be seen from one direction: the camera at `distance_m` from the centre of the bounding box.
struct ModelAspect {
  float direction[3];  // unit, from the box centre to the camera, model frame
  float distance_m;
  std::array<std::uint32_t, kMaxModelEdges / 32> visible_edges;  // bit e: at least half of edge e is visible
};

struct ModelSection {
  std::uint32_t offset;  // bytes from the start of the file
  std::uint32_t count;   // records
};

struct ModelFileHeader {
  std::uint32_t magic;
  std::uint32_t version;
  std::uint32_t file_size;  // bytes
  std::uint32_t crc32c;
  std::uint32_t id;          // BOP object id
  char name[kMaxModelName];  // zero-terminated
  float diameter_m;          // largest distance between two vertices
  float box_min_m[3];
  float box_max_m[3];
  ModelSection vertices, triangles, faces, edges, line_sets, set_members, symmetries, aspects;
};

static_assert(sizeof(ModelVertex) == 12 && sizeof(ModelTriangle) == 8 && sizeof(ModelFace) == 24);
static_assert(sizeof(ModelEdge) == 20 && sizeof(ModelLineSet) == 16 && sizeof(ModelSetMember) == 20);
static_assert(sizeof(ModelSymmetry) == 48 && sizeof(ModelAspect) == 16 + kMaxModelEdges / 8);
static_assert(sizeof(ModelFileHeader) == 20 + kMaxModelName + 28 + 64);

}  // namespace wirepose

#endif  // WIREPOSE_MODEL_MODEL_FORMAT_H_
