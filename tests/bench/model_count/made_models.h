// Models of objects that are in no scene: boxes and prisms of seeded sizes.
#ifndef WIREPOSE_TESTS_BENCH_MODEL_COUNT_MADE_MODELS_H_
#define WIREPOSE_TESTS_BENCH_MODEL_COUNT_MADE_MODELS_H_

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/model_compiler/model_compiler.h"

namespace wirepose::bench {

using Sides = std::array<double, 3>;  // of a bounding box, m, shortest first

Sides SidesOf(const ModelView& model);

// `count` models with ids from `first_id` on: half of them boxes, the others prisms with 3, 5, 6 or 8 corners. Sides
// are drawn between 0.08 and 0.6 m, evenly in their logarithm, and drawn again when all three are within 15 % of those
// of one in `avoided`. Same arguments, same models. Throws std::runtime_error.
std::vector<tools::CompiledModel> MakeModels(std::size_t count, std::uint32_t first_id, std::uint32_t seed,
                                             std::span<const Sides> avoided);

}  // namespace wirepose::bench

#endif  // WIREPOSE_TESTS_BENCH_MODEL_COUNT_MADE_MODELS_H_
