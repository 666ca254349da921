#include "tools/model_compiler/wireframe_drawing.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace wirepose::tools {
namespace {

constexpr int kSize_px = 900;
constexpr int kMargin_px = 50;
constexpr int kPieces = 120;  // each edge is drawn in pieces, each visible or hidden
constexpr int kSubpixelBits = 4;

Vector3d Position(const ModelView& m, std::size_t v) { return m.VertexPosition(v).cast<double>(); }

// A pinhole that looks at the centre of the box and fills the picture with its circumscribed
// sphere.
class Camera {
 public:
  explicit Camera(const ModelView& m) {
    const Vector3d centre = (0.5F * (m.box_min_m + m.box_max_m)).cast<double>();
    const Vector3d view = Vector3d(0.62, -1.0, 0.58).normalized();
    position_ = centre + 3 * static_cast<double>(m.diameter_m) * view;
    axes_.row(2) = -view;
    axes_.row(0) = Vector3d::UnitZ().cross(view).normalized();
    axes_.row(1) = axes_.row(2).cross(axes_.row(0));
    focal_px_ = (kSize_px / 2.0 - kMargin_px) * 3 / 0.5;
  }
  [[nodiscard]] const Vector3d& position() const { return position_; }
  [[nodiscard]] cv::Point Pixel(const Vector3d& p) const {
    const Vector3d c = axes_ * (p - position_);
    const double scale = 1 << kSubpixelBits;
    return {cvRound(scale * (kSize_px / 2.0 + focal_px_ * c.x() / c.z())),
            cvRound(scale * (kSize_px / 2.0 + focal_px_ * c.y() / c.z()))};
  }

 private:
  Vector3d position_;
  Matrix3d axes_;
  double focal_px_;
};

// Moeller and Trumbore 1997: where the segment from `from` to `to` crosses the triangle, as a
// fraction of the segment.
bool Crosses(const Vector3d& from, const Vector3d& to, const Vector3d& a, const Vector3d& b, const Vector3d& c,
             double& at) {
  const Vector3d d = to - from, e1 = b - a, e2 = c - a, p = d.cross(e2);
  const double det = e1.dot(p);
  if (std::abs(det) < 1e-18) return false;
  const Vector3d s = from - a, q = s.cross(e1);
  const double u = s.dot(p) / det, v = d.dot(q) / det;
  at = e2.dot(q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && at > 0;
}

bool IsHidden(const ModelView& m, const Vector3d& camera, const Vector3d& point) {
  const double limit = 1 - 1e-3 * static_cast<double>(m.diameter_m) / (point - camera).norm();
  return std::any_of(m.triangles.begin(), m.triangles.end(), [&](const ModelTriangle& t) {
    double at = 0;
    return Crosses(camera, point, Position(m, t.vertex[0]), Position(m, t.vertex[1]), Position(m, t.vertex[2]), at) &&
           at < limit;
  });
}

bool FacesCamera(const ModelView& m, const ModelEdge& e, const Vector3d& camera) {
  if (e.face[1] == kNoFace) return true;
  return std::any_of(std::begin(e.face), std::end(e.face), [&](std::uint16_t f) {
    return Vector3(m.faces[f].normal).cast<double>().dot(camera) > static_cast<double>(m.faces[f].offset_m);
  });
}

void DrawEdge(const ModelView& m, const Camera& camera, const ModelEdge& e, bool draw_hidden, cv::Mat& image) {
  const Vector3d a = Position(m, e.vertex[0]), b = Position(m, e.vertex[1]);
  const cv::Scalar visible_colour = e.face[1] == kNoFace ? cv::Scalar(40, 40, 200) : cv::Scalar(20, 20, 20);
  const bool faces_camera = FacesCamera(m, e, camera.position());
  for (int k = 0; k < kPieces; ++k) {
    const Vector3d p = a + (b - a) * k / kPieces, q = a + (b - a) * (k + 1) / kPieces;
    const bool hidden = !faces_camera || IsHidden(m, camera.position(), (p + q) / 2);
    if (hidden != draw_hidden) continue;
    if (hidden && k / 4 % 2 == 1) continue;  // the dashes
    cv::line(image, camera.Pixel(p), camera.Pixel(q), hidden ? cv::Scalar(190, 190, 190) : visible_colour,
             hidden ? 1 : 2, cv::LINE_AA, kSubpixelBits);
  }
}

}  // namespace

Result<void, std::string> DrawWireframe(const ModelView& model, const std::filesystem::path& png) {
  cv::Mat image(kSize_px, kSize_px, CV_8UC3, cv::Scalar::all(255));
  const Camera camera(model);
  for (const bool hidden : {true, false}) {  // visible lines lie on top
    for (const ModelEdge& e : model.edges) DrawEdge(model, camera, e, hidden, image);
  }
  bool written = false;
  try {
    written = cv::imwrite(png.string(), image);
  } catch (const cv::Exception&) {  // unknown extension
  }
  if (!written)
    return unexpected(png.string() + ": cannot be written; give a path in a writable folder that ends in .png");
  return {};
}

}  // namespace wirepose::tools
