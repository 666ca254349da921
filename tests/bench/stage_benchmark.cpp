// Single stages on the rectified frame.
#include "bench_frame.h"

namespace wirepose::bench {
namespace {

// What the feature stages write, for one eye.
struct Eye {
  SmoothPlane smooth;
  NormalizedPlane normalized;
  EdgeImage edges;
  EdgeMap map;
  Segments segments;
  SegmentScratch scratch;
};

struct Workspace {
  Rectification rectification;
  std::vector<std::uint8_t> image = std::vector<std::uint8_t>(kMaxPixels);
  Eye left, right;
  StereoScratch stereo;
  Lines3 lines;
  ImageLineSets sets;
};

void FindFeatures(ImageView image, const RectificationMap& map, Eye& eye) {
  SmoothImage(image, eye.smooth);
  FindRidges(eye.smooth, image.width, image.height, map, {}, eye.edges);
  BuildEdgeMap(eye.edges, eye.map);
  FindSegments({}, eye.edges, eye.scratch, eye.segments);
  NormalizeLocally(image, eye.normalized);
}

Workspace& Work() {
  static const auto work = [] {
    auto w = std::make_unique<Workspace>();
    (void)ComputeRectification(testing::GoldenCalibration(), w->rectification);
    FindFeatures(WarmRecognizer().left_rectified(), w->rectification.left, w->left);
    FindFeatures(WarmRecognizer().right_rectified(), w->rectification.right, w->right);
    return w;
  }();
  return *work;
}

void Rectify(benchmark::State& state) {
  for (auto _ : state)
    RectifyImage(Frame().left.view(), Work().rectification.left, {Work().image.data(), 640, 480, 640});
}

void Segments2D(benchmark::State& state) {
  Workspace& w = Work();
  for (auto _ : state) {
    SmoothImage(WarmRecognizer().left_rectified(), w.left.smooth);
    FindRidges(w.left.smooth, 640, 480, w.rectification.left, {}, w.left.edges);
    FindSegments({}, w.left.edges, w.left.scratch, w.left.segments);
  }
  state.counters["segments"] = static_cast<double>(w.left.segments.items.size());
}

void EdgeMaps(benchmark::State& state) {
  Workspace& w = Work();
  for (auto _ : state) BuildEdgeMap(w.left.edges, w.left.map);
}

void Normalization(benchmark::State& state) {
  for (auto _ : state) NormalizeLocally(WarmRecognizer().left_rectified(), Work().left.normalized);
}

void StereoLines(benchmark::State& state) {
  Workspace& w = Work();
  for (auto _ : state) {
    MatchLines({},
               {w.rectification.camera, w.left.normalized, w.right.normalized, w.right.smooth, w.rectification.right},
               w.left.segments, w.stereo, w.lines);
  }
  state.counters["lines"] = static_cast<double>(w.lines.size());
}

void LineSets(benchmark::State& state) {
  Workspace& w = Work();
  MatchLines({}, {w.rectification.camera, w.left.normalized, w.right.normalized, w.right.smooth, w.rectification.right},
             w.left.segments, w.stereo, w.lines);
  for (auto _ : state) FindLineSets({}, w.rectification.camera, w.lines, w.sets);
  state.counters["pairs"] = static_cast<double>(w.sets.pairs.size());
}

BENCHMARK(Rectify)->Name("stage/rectify_one_image")->Apply(WithPercentiles);
BENCHMARK(Segments2D)->Name("stage/segments_one_image")->Apply(WithPercentiles);
BENCHMARK(EdgeMaps)->Name("stage/edge_map_one_image")->Apply(WithPercentiles);
BENCHMARK(Normalization)->Name("stage/normalize_one_image")->Apply(WithPercentiles);
BENCHMARK(StereoLines)->Name("stage/stereo_lines")->Apply(WithPercentiles);
BENCHMARK(LineSets)->Name("stage/line_sets")->Apply(WithPercentiles);

}  // namespace
}  // namespace wirepose::bench
