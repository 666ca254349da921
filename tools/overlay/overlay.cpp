#include "tools/overlay/overlay.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include <fmt/format.h>

#include "tools/overlay/visible_edges.h"

namespace wirepose::overlay {
namespace {

constexpr int kEnlarge = 2;
constexpr int kSubPixelBits = 4;  // cv::line takes fixed-point coordinates
const cv::Scalar kGrey(150, 150, 150);
const cv::Scalar kFoundColour(80, 255, 80);
const cv::Scalar kTruthColour(255, 200, 0);
const cv::Scalar kWhite(255, 255, 255);

// Rectified pixel to enlarged, fixed-point pixel; pixel centres are at integers in both.
cv::Point ToCanvas(double u, double v) {
  const double scale = 1 << kSubPixelBits;
  const auto at = [&](double x) {
    const double enlarged = (x + 0.5) * kEnlarge - 0.5;
    return static_cast<int>(std::lround(std::clamp(enlarged, -1e5, 1e5) * scale));
  };
  return {at(u), at(v)};
}

void DrawLine(cv::Mat& canvas, const cv::Point2d& a, const cv::Point2d& b, const cv::Scalar& colour, int width) {
  cv::line(canvas, ToCanvas(a.x, a.y), ToCanvas(b.x, b.y), colour, width, cv::LINE_AA, kSubPixelBits);
}

cv::Point2d ToPoint(const Vector2& p) { return {static_cast<double>(p.x()), static_cast<double>(p.y())}; }

void DrawSegment(cv::Mat& canvas, const Segment2& s, const cv::Scalar& colour, int width) {
  DrawLine(canvas, ToPoint(s.a), ToPoint(s.b), colour, width);
}

// 3 px on, 3 px off.
void DrawDashed(cv::Mat& canvas, const cv::Point2d& a, const cv::Point2d& b, const cv::Scalar& colour) {
  constexpr double kDashPx = 3;
  const int dashes = std::clamp(static_cast<int>(cv::norm(b - a) / (2 * kDashPx)), 1, 1000);
  for (int i = 0; i < dashes; ++i) {
    DrawLine(canvas, a + (b - a) * ((i + 0.0) / dashes), a + (b - a) * ((i + 0.5) / dashes), colour, 1);
  }
}

// Text on a dark shadow, so that it reads on any image.
void DrawText(cv::Mat& canvas, const std::string& text, const cv::Point& at, const cv::Scalar& colour) {
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar(0, 0, 0), 4, cv::LINE_AA);
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.6, colour, 1, cv::LINE_AA);
}

// The image, enlarged and brought to one middling brightness: lines must stand out in any light.
cv::Mat Background(ImageView image) {
  constexpr double kMeanLevel = 90;
  cv::Mat grey(image.height, image.width, CV_8UC1);
  for (int y = 0; y < image.height; ++y) {
    std::copy_n(image.row(y), image.width, grey.ptr(y));
  }
  cv::Mat canvas;
  cv::resize(grey, canvas, {}, kEnlarge, kEnlarge, cv::INTER_LINEAR);
  const double gain = std::clamp(kMeanLevel / std::max(cv::mean(grey)[0], 1.0), 0.5, 2.0);
  cv::cvtColor(canvas * gain, canvas, cv::COLOR_GRAY2BGR);
  return canvas;
}

// Depth to colour: near red, far blue, on a scale that is even in disparity.
class DepthScale {
 public:
  explicit DepthScale(std::span<const Line3> lines) {
    std::vector<double> depths;
    for (const Line3& l : lines) {
      if (l.has_depth) depths.push_back(DepthOf(l));
    }
    if (depths.empty()) return;
    std::ranges::sort(depths);
    near_m_ = depths[depths.size() / 20];
    far_m_ = std::max(depths[depths.size() - 1 - depths.size() / 20], near_m_ * 1.01);
  }

  static double DepthOf(const Line3& l) { return 0.5 * static_cast<double>(l.a.z() + l.b.z()); }

  [[nodiscard]] cv::Scalar Colour(double depth_m) const {
    const double share = (1 / depth_m - 1 / far_m_) / (1 / near_m_ - 1 / far_m_);
    const cv::Mat1b level(1, 1, static_cast<std::uint8_t>(std::lround(std::clamp(share, 0.0, 1.0) * 215 + 30)));
    cv::Mat3b colour;
    cv::applyColorMap(level, colour, cv::COLORMAP_TURBO);
    return cv::Scalar(colour(0, 0));
  }

  void Draw(cv::Mat& canvas) const {
    constexpr int kSteps = 40;
    const cv::Rect bar(16, 46, 160, 12);
    for (int i = 0; i < kSteps; ++i) {
      const double inverse = 1 / near_m_ + (1 / far_m_ - 1 / near_m_) * i / (kSteps - 1);
      const cv::Rect cell(bar.x + i * bar.width / kSteps, bar.y, bar.width / kSteps, bar.height);
      cv::rectangle(canvas, cell, Colour(1 / inverse), cv::FILLED);
    }
    DrawText(canvas, fmt::format("{:.2f} m", near_m_), {bar.x, bar.y + 34}, kWhite);
    DrawText(canvas, fmt::format("{:.2f} m", far_m_), {bar.x + 110, bar.y + 34}, kWhite);
  }

 private:
  double near_m_ = 0.5;
  double far_m_ = 2;
};

// Hues a golden angle apart: neighbours in number differ in colour.
cv::Scalar SetColour(std::uint32_t set) {
  const double hue = std::fmod(25 + set * 180 * 0.381966, 180);
  const cv::Mat3b hsv(1, 1, cv::Vec3b(cv::saturate_cast<std::uint8_t>(hue), 200, 255));
  cv::Mat3b bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  return cv::Scalar(bgr(0, 0));
}

cv::Mat DrawLines(const OverlayInput& in) {
  cv::Mat canvas = Background(in.left_rectified);
  for (const Segment2& s : in.segments) DrawSegment(canvas, s, kGrey, 1);
  const DepthScale scale(in.lines);
  std::size_t with_depth = 0;
  for (const Line3& l : in.lines) {
    if (!l.has_depth) continue;
    ++with_depth;
    DrawSegment(canvas, l.segment, scale.Colour(DepthScale::DepthOf(l)), 2);
  }
  const std::string text = fmt::format("{} segments, {} with depth", in.segments.size(), with_depth);
  DrawText(canvas, text, {16, 30}, kWhite);
  if (with_depth > 0) scale.Draw(canvas);
  return canvas;
}

void DrawObject(cv::Mat& canvas, const OverlayObject& object, const RectifiedCamera& camera) {
  const bool found = object.kind == PoseKind::kFound;
  const cv::Scalar colour = found ? kFoundColour : kTruthColour;
  cv::Point2d sum(0, 0);
  int visible = 0;
  for (const EdgePiece& piece : CutEdges(object.model, object.T_rectified_model)) {
    const Vector3d a = camera.Project(piece.a);
    const Vector3d b = camera.Project(piece.b);
    const cv::Point2d from(a.x(), a.y());
    const cv::Point2d to(b.x(), b.y());
    if (piece.hidden) {
      DrawDashed(canvas, from, to, colour);
      continue;
    }
    DrawLine(canvas, from, to, colour, found ? 2 : 1);
    sum += 0.5 * (from + to);
    ++visible;
  }
  if (object.label.empty() || visible == 0) return;
  const cv::Point2d middle = sum / visible * kEnlarge;
  const cv::Point at(std::clamp(static_cast<int>(std::clamp(middle.x, 0.0, 1e4)) - 60, 4, canvas.cols - 200),
                     std::clamp(static_cast<int>(std::clamp(middle.y, 0.0, 1e4)), 76, canvas.rows - 24));
  DrawText(canvas, object.label, at, colour);
}

cv::Mat DrawObjects(const OverlayInput& in) {
  cv::Mat canvas = Background(in.left_rectified);
  // Truth below, what was found above: where both agree, the found one shows.
  for (const PoseKind kind : {PoseKind::kTruth, PoseKind::kFound}) {
    for (const OverlayObject& o : in.objects) {
      if (o.kind == kind) DrawObject(canvas, o, in.camera);
    }
  }
  for (const LineSetMember& m : in.line_sets) {
    if (m.line < in.lines.size()) DrawSegment(canvas, in.lines[m.line].segment, SetColour(m.set), 3);
  }
  const auto found = std::ranges::count(in.objects, PoseKind::kFound, &OverlayObject::kind);
  const bool has_truth = static_cast<std::size_t>(found) < in.objects.size();
  DrawText(canvas, fmt::format("{} found", found), {16, 30}, kFoundColour);
  if (has_truth)
    DrawText(canvas, fmt::format("{} true", in.objects.size() - static_cast<std::size_t>(found)), {16, 54},
             kTruthColour);
  return canvas;
}

}  // namespace

cv::Mat DrawOverlay(const OverlayInput& input) {
  cv::Mat both;
  cv::hconcat(DrawLines(input), DrawObjects(input), both);
  if (!input.caption.empty()) DrawText(both, input.caption, {16, both.rows - 12}, kWhite);
  return both;
}

}  // namespace wirepose::overlay
