// Reads a model file in place and refuses a bad one.
#ifndef WIREPOSE_MODEL_MODEL_PARSER_H_
#define WIREPOSE_MODEL_MODEL_PARSER_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.h"
#include "model/model_view.h"

namespace wirepose {

// Why a model file is refused; in the order in which it is checked.
enum class [[nodiscard]] ModelError : std::uint8_t{
    kMisaligned,     // the bytes do not start at a multiple of kModelAlignment
    kTooShort,       // fewer bytes than a header
    kNotAModel,      // wrong magic number
    kWrongVersion,   // written for another version of the format
    kWrongSize,      // the header's file size is not that of the file: truncated or with something
                     // appended
    kDamaged,        // CRC-32C does not match
    kBadName,        // empty, not terminated or not printable ASCII
    kBadSection,     // a section overlaps, leaves the file or is misaligned
    kOverCapacity,   // more records than src/capacities.h allows
    kEmpty,          // no vertices, triangles, faces or edges
    kBadDimensions,  // diameter or bounding box not finite or contradictory
    kBadVertex,      // not finite or outside the bounding box
    kBadTriangle,    // vertex or face index out of range
    kBadFace,        // not finite, normal not of unit length, or its triangles are not its own
    kBadEdge,        // index out of range, length wrong or not sorted by falling length
    kBadLineSet,     // index or range out of range, or unknown kind
    kBadSetMember,   // index out of range or parameter not finite or negative
    kBadSymmetry,    // not a rigid motion
    kBadAspect,      // direction not of unit length, or a bit set for an edge that does not exist
};

// One line for people: what is wrong and what to do.
const char* Describe(ModelError error);

inline constexpr std::size_t kModelAlignment = 8;

// The model in `file`, a whole .wpm file whose first byte is aligned to kModelAlignment. The view
// points into `file`, which stays owned by the caller and must not change while the view is used.
// Any bytes are safe to pass: a view that is returned is consistent (see ModelView). Thread safe;
// no allocation. O(size of the file).
Result<ModelView, ModelError> ParseModel(std::span<const std::byte> file);

}  // namespace wirepose

#endif  // WIREPOSE_MODEL_MODEL_PARSER_H_
