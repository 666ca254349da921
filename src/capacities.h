// Every limit of the recognizer, with its reason. Relations between limits are checked by the compiler.
// When a list is full it keeps its best elements and the number dropped is published.
#ifndef WIREPOSE_CAPACITIES_H_
#define WIREPOSE_CAPACITIES_H_

#include <cstddef>
#include <cstdint>

namespace wirepose {

// --- Image ---------------------------------------------------------------------------------------------------------
// The paper's camera. Static image planes are sized by it; wider inputs are refused when the calibration is loaded.
inline constexpr int kMaxImageWidth = 640;
inline constexpr int kMaxImageHeight = 480;
inline constexpr std::size_t kMaxPixels = std::size_t{kMaxImageWidth} * kMaxImageHeight;

// --- Features ------------------------------------------------------------------------------------------------------
// Real kitchens show 150-300 segments of 12 px and more; the longest are kept.
inline constexpr std::size_t kMaxSegments = 512;
// Pixels on edge ridges: a sixth of a 640x480 image; photographs of clutter have 15,000 to 30,000. The weakest go
// first.
inline constexpr std::size_t kMaxRidgePixels = 51200;
// One connected edge; longer than any straight line in the image.
inline constexpr std::size_t kMaxChain = 2048;

// Corners whose rows are compared between the eyes: one in each of 8 x 4 cells. Five numbers are estimated from them.
inline constexpr std::size_t kMaxRowOffsets = 32;

// Related pairs of image lines: 150 lines with depth make 11,000. Of 228 objects of fitting scenes 227 have a right
// pair among this many, and 39 on average.
inline constexpr std::size_t kMaxImageLinePairs = 2048;
// Corresponding line sets kept per model, by rank: the paper's "small number". 1,536 find as many objects.
inline constexpr std::size_t kMaxCorrespondences = 1024;
inline constexpr std::size_t kMaxSetLines = 8;  // lines of one corresponding set; more add nothing to a pose
// Pose hypotheses kept per model after the coarse score. Many of them are one pose.
inline constexpr std::size_t kMaxHypotheses = 128;
// Poses of one model whose line sets are promoted and ranked: a frame has 34 on average, and the right one may be any.
inline constexpr std::size_t kMaxPromoted = 64;
inline constexpr std::size_t kMaxRefined = 12;          // of these, refined and verified
inline constexpr std::size_t kMaxVerified = 64;         // of all models, that compete for the image's edges
inline constexpr std::size_t kMaxEdgeSamples = 512;     // points on visible edges of one pose; the step widens to fit
inline constexpr std::size_t kMaxSurfaceSamples = 192;  // points on visible faces of one pose; the step widens to fit

// --- Models --------------------------------------------------------------------------------------------------------
// Objects searched for at once: one bit each of a 32 bit selection. The memory budget of 8 MiB is stated for them.
inline constexpr std::size_t kMaxModels = 32;
inline constexpr std::size_t kMaxModelVertices = 512;  // a refrigerator with two doors and handles has 118
inline constexpr std::size_t kMaxModelTriangles = 1024;
inline constexpr std::size_t kMaxModelFaces = 256;   // planar surfaces after coplanar triangles are merged
inline constexpr std::size_t kMaxModelEdges = 256;   // crease edges; also the width of a visibility bit set
inline constexpr std::size_t kMaxLineSetEdges = 48;  // longest edges, the only ones that found line sets
inline constexpr std::size_t kMaxModelLineSets = 2 * kMaxLineSetEdges;  // one parallel, one intersecting per base line
inline constexpr std::size_t kMaxModelSetMembers = kMaxLineSetEdges * (kMaxLineSetEdges - 1);
inline constexpr std::size_t kMaxModelSymmetries = 24;  // rotations of a cube, identity included
inline constexpr std::size_t kMaxModelFeet = 24;        // faces that an object can stand on, the largest ones
inline constexpr std::size_t kMaxNearTurns = 3;         // turns that nearly are symmetries; a detection tries each
inline constexpr std::size_t kMaxModelAspects = 162;    // directions of a twice subdivided icosahedron
inline constexpr std::size_t kMaxModelName = 32;        // bytes, zero-terminated

static_assert(kMaxModelEdges % 32 == 0, "visibility bits are stored in 32 bit words");
static_assert(kMaxLineSetEdges <= kMaxModelEdges);
static_assert(kMaxModelVertices < 0xFFFF && kMaxModelTriangles < 0xFFFF, "indices are 16 bits wide");

// --- Output --------------------------------------------------------------------------------------------------------
inline constexpr std::size_t kMaxDetections = 16;  // objects in one frame; also the bound of the DDS sequences
inline constexpr std::size_t kMaxModes = 4;        // poses that the visible evidence of one detection cannot tell apart

// --- Over frames ---------------------------------------------------------------------------------------------------
inline constexpr std::size_t kMaxTracks = 32;  // objects followed at once: twice what a frame can show
inline constexpr std::size_t kMaxPriors = 16;  // predicted poses that a frame tries: as many as it can report

}  // namespace wirepose

#endif  // WIREPOSE_CAPACITIES_H_
