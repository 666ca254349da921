// What the peers' features are made of: points with normals, of a model or of a cloud.
#ifndef WIREPOSE_TESTS_BENCH_PEER_ORIENTED_POINTS_H_
#define WIREPOSE_TESTS_BENCH_PEER_ORIENTED_POINTS_H_

#include <opencv2/core.hpp>
#include <vector>

#include "dense_cloud.h"
#include "mesh/mesh.h"

namespace wirepose::bench {

inline constexpr double kLargePlaneD = 1.12;  // diameters; planes larger than this are no part of the object

struct OrientedPoint {
  cv::Vec3f point, normal;  // m; normal of unit length
};

// Points all over the triangles, `step_m` apart, with outward normals. The same ones at every call.
std::vector<OrientedPoint> Sample(const mesh::Mesh& mesh, double step_m);

// One mean point a cell of `step_m`; points of different orientation are kept apart. In a fixed order.
std::vector<OrientedPoint> Thin(const std::vector<OrientedPoint>& points, double step_m);

// Points that may belong to an object of this size: with a normal and not on a larger plane.
std::vector<OrientedPoint> Candidates(const DenseCloud& cloud, double diameter_m);

std::vector<OrientedPoint> Near(const std::vector<OrientedPoint>& points, const cv::Vec3f& centre, double radius_m);

// Overlapping parts of the scene, each about as large as the object, as indices of its points.
std::vector<std::vector<int>> Tiles(const std::vector<OrientedPoint>& scene, double diameter_m);

}  // namespace wirepose::bench

#endif  // WIREPOSE_TESTS_BENCH_PEER_ORIENTED_POINTS_H_
