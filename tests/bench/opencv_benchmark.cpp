// The same work by OpenCV, in the same run and on one thread: its line detectors, dense stereo and
// point-pair features.
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#ifdef WIREPOSE_HAS_XIMGPROC
#include <opencv2/ximgproc/fast_line_detector.hpp>
#endif
#ifdef WIREPOSE_HAS_SURFACE_MATCHING
#include <opencv2/surface_matching.hpp>
#include <opencv2/surface_matching/ppf_helpers.hpp>
#endif

#include "bench_frame.h"

namespace wirepose::bench {
namespace {

cv::Mat ToMat(ImageView image) {
  cv::Mat out(image.height, image.width, CV_8U);
  for (int y = 0; y < image.height; ++y) std::copy_n(image.row(y), image.width, out.ptr(y));
  return out;
}

void Lsd(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat image = ToMat(WarmRecognizer().left_rectified());
  const auto detector = cv::createLineSegmentDetector();
  std::vector<cv::Vec4f> lines;
  for (auto _ : state) detector->detect(image, lines);
  state.counters["segments"] = static_cast<double>(lines.size());
}
BENCHMARK(Lsd)->Name("opencv/LSD_one_image")->Apply(WithPercentiles);

#ifdef WIREPOSE_HAS_XIMGPROC
void Fld(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat image = ToMat(WarmRecognizer().left_rectified());
  const auto detector = cv::ximgproc::createFastLineDetector(12);
  std::vector<cv::Vec4f> lines;
  for (auto _ : state) detector->detect(image, lines);
  state.counters["segments"] = static_cast<double>(lines.size());
}
BENCHMARK(Fld)->Name("opencv/FastLineDetector_one_image")->Apply(WithPercentiles);
#endif

cv::Mat DenseDisparity() {
  const auto matcher = cv::StereoSGBM::create(0, 128, 7, 8 * 49, 32 * 49, 1, 31, 10, 100, 2);
  cv::Mat disparity;
  matcher->compute(ToMat(WarmRecognizer().left_rectified()), ToMat(WarmRecognizer().right_rectified()), disparity);
  return disparity;
}

void Sgbm(benchmark::State& state) {
  cv::setNumThreads(1);
  for (auto _ : state) benchmark::DoNotOptimize(DenseDisparity().data);
}
BENCHMARK(Sgbm)->Name("opencv/StereoSGBM")->Apply(WithPercentiles);

#ifdef WIREPOSE_HAS_SURFACE_MATCHING
// Points with normals of one model's faces, about 1 cm apart.
cv::Mat ModelPoints(const ModelView& model) {
  cv::Mat points(0, 6, CV_32F);
  for (const ModelTriangle& t : model.triangles) {
    const Vector3 a = model.VertexPosition(t.vertex[0]), b = model.VertexPosition(t.vertex[1]),
                  c = model.VertexPosition(t.vertex[2]);
    const Vector3 n = (b - a).cross(c - a).normalized();
    const int steps = std::max(1, static_cast<int>(std::max((b - a).norm(), (c - a).norm()) / 0.01F));
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const Vector3 p = a + static_cast<float>(i) / static_cast<float>(steps) * (b - a) +
                          static_cast<float>(j) / static_cast<float>(steps) * (c - a);
        const cv::Mat row = (cv::Mat_<float>(1, 6) << p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
        points.push_back(row);
      }
    }
  }
  return points;
}

cv::Mat ScenePoints() {
  const cv::Mat disparity = DenseDisparity();
  const RectifiedCamera& camera = WarmRecognizer().camera();
  cv::Mat points(0, 3, CV_32F);
  for (int y = 0; y < disparity.rows; y += 8) {
    for (int x = 0; x < disparity.cols; x += 8) {
      const double d = disparity.at<std::int16_t>(y, x) / 16.0;
      if (d < 20) continue;
      const Vector3 p = camera.Triangulate(x, y, d).cast<float>();
      const cv::Mat row = (cv::Mat_<float>(1, 3) << p.x(), p.y(), p.z());
      points.push_back(row);
    }
  }
  cv::Mat with_normals;
  cv::ppf_match_3d::computeNormalsPC3d(points, with_normals, 12, true, cv::Vec3f(0, 0, 0));
  return with_normals;
}

// One model, at a coarse setting: the usual one takes minutes. The training and the dense stereo
// before it are not counted.
void PointPairFeatures(benchmark::State& state) {
  cv::setNumThreads(1);
  cv::ppf_match_3d::PPF3DDetector detector(0.1, 0.1);
  detector.trainModel(ModelPoints(Models()[0].View()));
  const cv::Mat scene = ScenePoints();
  std::vector<cv::ppf_match_3d::Pose3DPtr> poses;
  for (auto _ : state) detector.match(scene, poses, 1.0 / 10, 0.03);
  state.counters["points"] = scene.rows;
}
BENCHMARK(PointPairFeatures)->Name("opencv/surface_matching_one_model")->Unit(benchmark::kMillisecond)->Iterations(1);
#endif

}  // namespace
}  // namespace wirepose::bench
