// What is printed on boxes, books, posters and stuck on refrigerator doors.
#ifndef WIREPOSE_SIM_PRINT_H_
#define WIREPOSE_SIM_PRINT_H_

#include <cstdint>

#include "sim/texture.h"

namespace wirepose::sim {

// A place on one face, as a reader in front of it sees it: x to the right, y up, metres from the
// lower left corner.
struct FacePoint {
  float x = 0, y = 0;
  float width = 0, height = 0;
  std::uint32_t seed = 0;  // of this face
};

// All give an albedo. `m.albedo` is the ground's, `m.second_albedo` the ink's.
[[nodiscard]] float ParcelPrint(const Material& m, const FacePoint& f);   // cardboard: tape, labels, stamps
[[nodiscard]] float GroceryPrint(const Material& m, const FacePoint& f);  // brand, picture, small print, bar code
[[nodiscard]] float BookCover(const Material& m, const FacePoint& f);
[[nodiscard]] float BookSpine(const Material& m, const FacePoint& f);
[[nodiscard]] float BookPages(const Material& m, const FacePoint& f, bool lines_along_x);
[[nodiscard]] float PosterPrint(const Material& m, const FacePoint& f);
// Notes, photographs and magnets on a painted door.
[[nodiscard]] float DoorPrint(const Material& m, const FacePoint& f);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_PRINT_H_
