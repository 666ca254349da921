// Which triangles meet at each edge of a mesh.
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_EDGE_MAP_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_EDGE_MAP_H_

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "mesh/mesh.h"

namespace wirepose::tools {

// (smaller vertex index, larger vertex index)
using EdgeKey = std::pair<int, int>;
// Ordered, so that everything derived from it has an order that does not depend on hashing.
using EdgeMap = std::map<EdgeKey, std::vector<int>>;

inline EdgeKey MakeEdgeKey(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

// The triangles at every edge, by rising index. O(n log n).
inline EdgeMap MakeEdgeMap(const mesh::Mesh& mesh) {
  EdgeMap edges;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const auto& v = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) edges[MakeEdgeKey(v[k], v[(k + 1) % 3])].push_back(t);
  }
  return edges;
}

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_EDGE_MAP_H_
