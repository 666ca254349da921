// What the recognizer's memory is made of.
#include <cstdio>

#include "bench_frame.h"

namespace wirepose::bench {
namespace {

std::size_t g_sum = 0;

void Row(const char* name, std::size_t bytes, std::size_t count) {
  g_sum += bytes * count;
  std::printf("%-34s %10zu x %2zu %10.1f KiB\n", name, bytes, count,
              static_cast<double>(bytes * count) / 1024);
}

}  // namespace

void PrintMemoryTable() {
  g_sum = 0;
  std::printf("\nStatic memory, bytes\n");
  Row("Rectification", sizeof(Rectification), 1);
  Row("rectified images", kMaxPixels, 2);
  Row("SmoothPlane", sizeof(SmoothPlane), 2);
  Row("NormalizedPlane", sizeof(NormalizedPlane), 2);
  Row("EdgeImage", sizeof(EdgeImage), 1);
  Row("EdgeMap", sizeof(EdgeMap), 2);
  Row("Segments", sizeof(Segments), 2);
  Row("Lines3", sizeof(Lines3), 1);
  Row("ImageLineSets", sizeof(ImageLineSets), 1);
  Row("CorrespondingPairs", sizeof(CorrespondingPairs), 1);
  Row("Hypotheses", sizeof(Hypotheses), 1);
  Row("CorrespondingSets", sizeof(CorrespondingSets), 1);
  Row("Candidates", sizeof(Candidates), 1);
  Row("PreparedModel", sizeof(PreparedModel), kMaxModels);
  Row("ModelView", sizeof(ModelView), kMaxModels);
  Row("SegmentScratch", sizeof(SegmentScratch), 1);
  Row("StereoScratch", sizeof(StereoScratch), 1);
  Row("RefineScratch", sizeof(RefineScratch), 1);
  Row("VerifyScratch", sizeof(VerifyScratch), 1);
  Row("ClaimMap", sizeof(ClaimMap), 1);
  std::printf("%-34s %27.1f KiB\n%-34s %27.1f KiB\n", "sum of the above",
              static_cast<double>(g_sum) / 1024, "sizeof(Recognizer)",
              static_cast<double>(sizeof(Recognizer)) / 1024);
}

}  // namespace wirepose::bench
