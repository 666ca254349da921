// Which parts of a model's edges each eye sees.
#ifndef WIREPOSE_SIM_EDGE_TRUTH_H_
#define WIREPOSE_SIM_EDGE_TRUTH_H_

#include <array>
#include <vector>

#include "hal/dataset/dataset_writer.h"
#include "sim/renderer.h"

namespace wirepose::sim {

// The mesh's edges at which its faces turn by more than 20 degrees, and those with one face only;
// vertices at one place (1 um) count as one. Ends in the mesh's frame and unit, in the order of the
// triangles. O(triangles log triangles).
[[nodiscard]] std::vector<std::array<Vector3d, 2>> SharpEdges(const Mesh& mesh);

// The visible parts of the sharp edges of one instance: inside the image and with nothing before
// them, found at places that are at most `step_px` apart, so ends are uncertain by half of that.
// Exact otherwise. O(edge length in pixels) rays.
[[nodiscard]] std::vector<dataset::EdgePart> VisibleEdgeParts(const Renderer& renderer, const Camera& camera,
                                                              int instance, double step_px = 0.5);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_EDGE_TRUTH_H_
