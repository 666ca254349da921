// Things that are not looked for. Used inside this room only.
#ifndef WIREPOSE_SIM_CLUTTER_H_
#define WIREPOSE_SIM_CLUTTER_H_

#include "sim/scene_builder.h"

namespace wirepose::sim {

struct Thing {
  Mesh mesh;
  Material material;
  bool is_cuboid = false;  // may lie on any side
};

// A can, jar, bottle, mug, plate, bowl, carton, book, board, roll, knife block, toaster ...
// No book or box has the proportions of the project's own models.
[[nodiscard]] Thing DrawThing(Random& random);

// Something large enough to hide a part of an object: a tall carton, a roll, a bottle, a box.
[[nodiscard]] Thing DrawOccluder(Random& random);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_CLUTTER_H_
