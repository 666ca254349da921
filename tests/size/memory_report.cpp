// Prints what the recognizer's memory is made of, as the table of docs/memory.md. Ends with status 1 when it exceeds
// the budget or when the table does not name nearly all of it. Run by scripts/memory-doc and as a test.
#include <algorithm>
#include <cstdio>

#include "pipeline/recognizer.h"

namespace wirepose {
namespace {

constexpr std::size_t kBudget = 8 * 1024 * 1024;  // docs/memory.md: at 640 x 480 with 32 models
constexpr std::size_t kMayBeMissing = 16 * 1024;  // parameters, counts and padding, which have no row

struct Member {
  const char* name;
  std::size_t bytes, count;
  const char* capacity;  // what its size follows from, in src/capacities.h unless said otherwise
  const char* reason;
};

constexpr Member kMembers[] = {
    {"rectification maps", sizeof(Rectification), 1, "one node every 8 px",
     "both eyes; between nodes positions are linear"},
    {"prepared models", sizeof(PreparedModel), kMaxModels, "kMaxModels, kMaxModelEdges, kMaxModelSetMembers",
     "what matching reads of each model"},
    {"model views", sizeof(ModelView), kMaxModels, "kMaxModels", "spans into the model files, which the caller owns"},
    {"rectified images", kMaxPixels, 2, "kMaxPixels", "both eyes"},
    {"smoothed images", sizeof(SmoothPlane), 2, "kMaxPixels x 16 bit", "edges, sub-pixel profiles"},
    {"normalized images", sizeof(NormalizedPlane), 2, "kMaxPixels", "stereo lines, disparity map"},
    {"stage scratch", std::max({sizeof(EdgeImage), sizeof(DisparityScratch), sizeof(DisparityImage)}), 1,
     "kMaxPixels, kMaxRidgePixels",
     "gradients and ridges of one eye at a time, then the rows of the disparity map or the depth of every pixel, then "
     "the "
     "costs of a corner"},
    {"disparity map", sizeof(DisparityMap), 1, "kMaxPixels / 4", "surfaces between the lines"},
    {"edge maps", sizeof(EdgeMap), 2, "kMaxPixels / 4 x 16 directions", "one look-up a sample when poses are scored"},
    {"2D segments", sizeof(Segments), 2, "kMaxSegments",
     "real kitchens show 150 to 300; the longest are kept; all, and those in the region that is searched"},
    {"3D lines", sizeof(Lines3), 1, "kMaxSegments", "one a left segment"},
    {"corners and row offsets", sizeof(Corners) + sizeof(RowOffsets), 1, "kMaxRowOffsets",
     "whether both eyes see things on equal rows"},
    {"image line sets", sizeof(ImageLineSets), 1, "kMaxImageLinePairs",
     "ranked by quality, then measured and grouped by base line"},
    {"corresponding pairs", sizeof(CorrespondingPairs), 1, "kMaxCorrespondences", "of one model at a time"},
    {"hypotheses", sizeof(Hypotheses), 1, "kMaxHypotheses", "of one model at a time"},
    {"corresponding sets", sizeof(CorrespondingSets), 1, "kMaxPromoted", "of one model at a time"},
    {"refined candidates", sizeof(Candidate) * (kMaxRefined + kMaxPriors), 1, "kMaxRefined + kMaxPriors",
     "of one model at a time"},
    {"priors", sizeof(PosePrior) * kMaxPriors, 1, "kMaxPriors", "predicted poses to start from"},
    {"candidates", sizeof(Candidates), 1, "kMaxVerified", "of all models"},
    {"segment scratch", sizeof(SegmentScratch), 1, "kMaxChain", "one connected edge"},
    {"stereo scratch", sizeof(StereoScratch), 1, "kMaxStereoRows x kMaxDisparity", "costs of one line"},
    {"refinement scratch", sizeof(RefineScratch), 1, "kMaxEdgeSamples, kMaxModelTriangles, kMaxSurfaceSamples",
     "one pose"},
    {"verification scratch", sizeof(VerifyScratch), 1, "kMaxEdgeSamples, kMaxModelTriangles", "one pose"},
    {"claim map", sizeof(ClaimMap), 1, "4 x 4 px blocks", "which detection owns an image edge"},
};

double Kib(std::size_t bytes) { return static_cast<double>(bytes) / 1024; }

int Report() {
  std::size_t sum = 0;
  std::printf("| member | KiB | capacity | for |\n|---|---:|---|---|\n");
  for (const Member& m : kMembers) {
    sum += m.bytes * m.count;
    if (m.count == 1) {
      std::printf("| %s | %.1f | %s | %s |\n", m.name, Kib(m.bytes), m.capacity, m.reason);
    } else {
      std::printf("| %s | %.1f = %zu x %.1f | %s | %s |\n", m.name, Kib(m.bytes * m.count), m.count, Kib(m.bytes),
                  m.capacity, m.reason);
    }
  }
  std::printf("| parameters, counts, padding | %.1f | | |\n", Kib(sizeof(Recognizer) - sum));
  std::printf("| **whole recognizer** | **%.1f = %.2f MiB** | | budget %zu MiB |\n", Kib(sizeof(Recognizer)),
              Kib(sizeof(Recognizer)) / 1024, kBudget >> 20);
  if (sizeof(Recognizer) > kBudget) {
    std::fprintf(stderr,
                 "memory_report: the recognizer takes %zu bytes, more than its budget of %zu; see src/capacities.h\n",
                 sizeof(Recognizer), kBudget);
    return 1;
  }
  if (sum > sizeof(Recognizer) || sizeof(Recognizer) - sum > kMayBeMissing) {
    std::fprintf(stderr,
                 "memory_report: the members sum up to %zu bytes, the recognizer has %zu; add what is missing\n", sum,
                 sizeof(Recognizer));
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace wirepose

int main() { return wirepose::Report(); }
