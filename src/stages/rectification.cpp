#include "stages/rectification.h"

#include <algorithm>
#include <cmath>

#include "base/simd.h"
#include "geometry/rotation.h"

namespace wirepose {
namespace {

constexpr double kFixedOne = 65536.0;
// Far outside every image and inside int32: where a ray points behind the lens model.
constexpr double kFarOutside = -16000.0;

// The rotation whose square is R: its quaternion is the normalised sum of R's and the identity's.
Matrix3d HalfRotation(const Matrix3d& R) {
  Eigen::Quaterniond q(Orthonormalize(R));
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  q.w() += 1;
  q.normalize();
  return q.toRotationMatrix();
}

// The smallest rotation that turns unit vector `from` into `to` (not opposite).
Matrix3d RotationBetween(const Vector3d& from, const Vector3d& to) {
  const Matrix3d V = Skew(from.cross(to));
  return Matrix3d::Identity() + V + V * V / (1 + from.dot(to));
}

// Removes the lens distortion of the raw image centre's ray; few fixed-point steps suffice near the axis.
Vector3d RayOfPixel(const CameraIntrinsics& camera, double u, double v) {
  const double xd = (u - camera.cx) / camera.fx;
  const double yd = (v - camera.cy) / camera.fy;
  double x = xd, y = yd;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d p = DistortAndProject(camera, x, y);
    x -= (p.x() - u) / camera.fx;
    y -= (p.y() - v) / camera.fy;
  }
  return {x, y, 1};
}

void FillMap(const CameraIntrinsics& raw, const Matrix3d& R_raw_rectified, const RectifiedCamera& camera,
             RectificationMap& map) {
  for (int j = 0; j < RectificationMap::kNodesY; ++j) {
    for (int i = 0; i < RectificationMap::kNodesX; ++i) {
      const Vector3d ray((i * RectificationMap::kNodeStep - camera.cx) / camera.f,
                         (j * RectificationMap::kNodeStep - camera.cy) / camera.f, 1);
      const Vector3d p = R_raw_rectified * ray;
      Eigen::Vector2d q(kFarOutside, kFarOutside);
      if (p.z() > 0.1) q = DistortAndProject(raw, p.x() / p.z(), p.y() / p.z());
      // Also catches NaN: every comparison with it is false.
      if (!(std::abs(q.x()) < 16000 && std::abs(q.y()) < 16000)) q = {kFarOutside, kFarOutside};
      map.nodes[static_cast<std::size_t>(j * RectificationMap::kNodesX + i)] = {
          static_cast<std::int32_t>(std::floor(q.x() * kFixedOne + 0.5)),
          static_cast<std::int32_t>(std::floor(q.y() * kFixedOne + 0.5))};
    }
  }
}

// One row of the map, interpolated between nodes: raw coordinates of 8 pixels advance by a constant step.
struct RowCursor {
  const RectificationMap& map;
  int y;

  [[nodiscard]] RectificationMap::Node At(int i) const {
    constexpr int kStep = RectificationMap::kNodeStep;
    const int j = y / kStep;
    const int fraction = y % kStep;
    const auto* row = map.nodes.data() + j * RectificationMap::kNodesX;
    const auto& a = row[i];
    if (fraction == 0) return a;
    const auto& b = row[i + RectificationMap::kNodesX];
    const auto mix = [&](std::int32_t p, std::int32_t q) {
      return static_cast<std::int32_t>(p + (std::int64_t{q} - p) * fraction / kStep);
    };
    return {mix(a.x, b.x), mix(a.y, b.y)};
  }
};

// Calls `use(x, raw_x, raw_y)` for every pixel of a row.
template <typename Use>
void ForEachPixel(const RectificationMap& map, int y, int width, const Use& use) {
  constexpr int kStep = RectificationMap::kNodeStep;
  const RowCursor cursor{map, y};
  RectificationMap::Node from = cursor.At(0);
  for (int x0 = 0; x0 < width; x0 += kStep) {
    const RectificationMap::Node to = cursor.At(x0 / kStep + 1);
    const std::int32_t dx = (to.x - from.x) / kStep;
    const std::int32_t dy = (to.y - from.y) / kStep;
    const int count = std::min(kStep, width - x0);
    for (int i = 0; i < count; ++i) use(x0 + i, from.x + i * dx, from.y + i * dy);
    from = to;
  }
}

// The longest run of valid pixels in each row; the valid region of a lens is convex, so there is only one.
void FillValid(const RectifiedCamera& camera, RectificationMap& map) {
  const std::int32_t max_x = (camera.width - 1) * 65536;
  const std::int32_t max_y = (camera.height - 1) * 65536;
  for (int y = 0; y < camera.height; ++y) {
    RectificationMap::Interval best, run;
    ForEachPixel(map, y, camera.width, [&](int x, std::int32_t u, std::int32_t v) {
      if (u < 0 || v < 0 || u > max_x || v > max_y) return;
      if (run.end != x) run = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(x)};
      run.end = static_cast<std::int16_t>(x + 1);
      if (run.end - run.begin > best.end - best.begin) best = run;
    });
    map.valid[static_cast<std::size_t>(y)] = best;
  }
}

bool IsUsable(const CameraIntrinsics& c) {
  const bool finite = std::isfinite(c.cx) && std::isfinite(c.cy) && std::isfinite(c.k1) && std::isfinite(c.k2) &&
                      std::isfinite(c.k3) && std::isfinite(c.p1) && std::isfinite(c.p2);
  return finite && c.fx > 1 && c.fy > 1 && c.fx < 1e5 && c.fy < 1e5;
}

// One row at work: where its pixels lie in the raw image, whole pixels as an offset and the rest (0..256; 256 in the
// last column and row only), and the four raw pixels around each place in one word.
struct RowScratch {
  std::array<std::int32_t, kMaxImageWidth> u, v;
  std::array<std::uint32_t, kMaxImageWidth> offset, four;
};

// Raw pixels between two nodes: the first, and the step from one to the next.
struct Run {
  RectificationMap::Node at, step;
};

// Pixels x0 to x0 + kNodeStep - 1. Those that are not valid get offsets that must not be looked up.
WIREPOSE_INLINE void SplitPlaces(const Run& run, const ImageView& raw, int x0, RowScratch& s) {
  const int last_x = raw.width - 2, last_y = raw.height - 2, stride = raw.stride;
  for (int k = 0; k < RectificationMap::kNodeStep; ++k) {
    const auto i = static_cast<std::size_t>(x0 + k);
    const std::int32_t u = run.at.x + k * run.step.x, v = run.at.y + k * run.step.y;
    const std::int32_t xi = (u >> 16) < last_x ? u >> 16 : last_x, yi = (v >> 16) < last_y ? v >> 16 : last_y;
    s.offset[i] = static_cast<std::uint32_t>(yi * stride + xi);
    s.u[i] = (u - (xi << 16)) >> 8;
    s.v[i] = (v - (yi << 16)) >> 8;
  }
}

using Runs = std::array<Run, RectificationMap::kNodesX>;

// Runs [begin, end) of a row.
WIREPOSE_VECTOR_KERNEL void PlaceRow(const Runs& runs, const ImageView& raw, int begin, int end, RowScratch& s) {
  for (int k = begin; k < end; ++k) {
    SplitPlaces(runs[static_cast<std::size_t>(k)], raw, k * RectificationMap::kNodeStep, s);
  }
}

// Exact in integers, whatever the order of the sums.
WIREPOSE_VECTOR_KERNEL void BlendRow(const RowScratch& s, int begin, int end, std::uint8_t* row) {
  for (int x = begin; x < end; ++x) {
    const auto i = static_cast<std::size_t>(x);
    const auto a = static_cast<std::int32_t>(s.four[i] & 255), b = static_cast<std::int32_t>(s.four[i] >> 8 & 255);
    const auto c = static_cast<std::int32_t>(s.four[i] >> 16 & 255), d = static_cast<std::int32_t>(s.four[i] >> 24);
    const std::int32_t top = 256 * a + (b - a) * s.u[i], bottom = 256 * c + (d - c) * s.u[i];
    row[x] = static_cast<std::uint8_t>((256 * top + (bottom - top) * s.v[i] + 32768) >> 16);
  }
}

// Runs [begin, end) of a row.
void FindRuns(const RowCursor& cursor, int begin, int end, Runs& runs) {
  constexpr int kStep = RectificationMap::kNodeStep;
  RectificationMap::Node from = cursor.At(begin);
  for (int k = begin; k < end; ++k) {
    const RectificationMap::Node to = cursor.At(k + 1);
    runs[static_cast<std::size_t>(k)] = {from, {(to.x - from.x) / kStep, (to.y - from.y) / kStep}};
    from = to;
  }
}

// Bilinear values of columns [begin, end): arithmetic in vectors, only the look-up goes pixel by pixel.
void ResampleRow(ImageView raw, const RowCursor& cursor, int begin, int end, RowScratch& s, std::uint8_t* row) {
  constexpr int kStep = RectificationMap::kNodeStep;
  const int first = begin / kStep, last = (end + kStep - 1) / kStep;
  Runs runs;
  FindRuns(cursor, first, last, runs);
  PlaceRow(runs, raw, first, last, s);
  for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
    const std::uint8_t* p = raw.data + s.offset[i];
    const std::uint8_t* q = p + raw.stride;
    s.four[i] = static_cast<std::uint32_t>(p[0] | p[1] << 8) | static_cast<std::uint32_t>(q[0] | q[1] << 8) << 16;
  }
  BlendRow(s, begin, end, row);
}

}  // namespace

Eigen::Vector2d DistortAndProject(const CameraIntrinsics& c, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double xd = x * radial + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x);
  const double yd = y * radial + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y;
  return {c.fx * xd + c.cx, c.fy * yd + c.cy};
}

bool ComputeRectification(const StereoCalibration& calibration, Rectification& out) {
  const Pose& T = calibration.T_right_left;
  if (!IsUsable(calibration.left) || !IsUsable(calibration.right) || !IsRotation(T.R)) return false;
  const double baseline = T.t.norm();
  if (!(baseline > 1e-4 && baseline < 100)) return false;

  // Half of the relative rotation for each camera; then the baseline into the x axis.
  const Matrix3d half = HalfRotation(T.R);
  if (half(2, 2) < 0.866) return false;
  const Vector3d direction = half.transpose() * T.t / baseline;  // of the left centre, seen from the right camera
  if (direction.x() > -0.5) return false;
  const Matrix3d align = RotationBetween(direction, Vector3d(-1, 0, 0));
  const Matrix3d R_left = Orthonormalize(align * half);
  const Matrix3d R_right = Orthonormalize(align * half.transpose());

  RectifiedCamera camera;
  camera.width = calibration.width;
  camera.height = calibration.height;
  camera.baseline = baseline;
  camera.f = 0.25 * (calibration.left.fx + calibration.left.fy + calibration.right.fx + calibration.right.fy);
  const double u0 = 0.5 * (calibration.width - 1);
  const double v0 = 0.5 * (calibration.height - 1);
  const Vector3d left = R_left * RayOfPixel(calibration.left, u0, v0);
  const Vector3d right = R_right * RayOfPixel(calibration.right, u0, v0);
  camera.cx = u0 - camera.f * 0.5 * (left.x() / left.z() + right.x() / right.z());
  camera.cy = v0 - camera.f * 0.5 * (left.y() / left.z() + right.y() / right.z());
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy)) return false;

  out.camera = camera;
  out.T_rectified_raw = {R_left, Vector3d::Zero()};
  FillMap(calibration.left, R_left.transpose(), camera, out.left);
  FillMap(calibration.right, R_right.transpose(), camera, out.right);
  FillValid(camera, out.left);
  FillValid(camera, out.right);
  return true;
}

bool ComputeUndistortion(const DepthCalibration& calibration, Rectification& out) {
  const CameraIntrinsics& raw = calibration.camera;
  if (!IsUsable(raw)) return false;
  RectifiedCamera camera;
  camera.width = calibration.width;
  camera.height = calibration.height;
  camera.has_right_image = false;
  camera.baseline = kVirtualBaselineM;
  camera.f = 0.5 * (raw.fx + raw.fy);
  // The middle of the image stays where it is.
  const double u0 = 0.5 * (calibration.width - 1);
  const double v0 = 0.5 * (calibration.height - 1);
  const Vector3d middle = RayOfPixel(raw, u0, v0);
  camera.cx = u0 - camera.f * middle.x();
  camera.cy = v0 - camera.f * middle.y();
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy)) return false;
  out.camera = camera;
  out.T_rectified_raw = {};
  FillMap(raw, Matrix3d::Identity(), camera, out.left);
  FillValid(camera, out.left);
  out.right.valid.fill({});
  return true;
}

void RectifyDepth(BasicImageView<const std::uint16_t> raw, const RectificationMap& map, int width, int height,
                  std::uint16_t* out) {
  for (int y = 0; y < height; ++y) {
    const auto [begin, end] = map.valid[static_cast<std::size_t>(y)];
    std::uint16_t* row = out + static_cast<std::ptrdiff_t>(y) * kMaxImageWidth;
    std::fill(row, row + width, std::uint16_t{0});
    ForEachPixel(map, y, width, [&, first = begin, last = end](int x, std::int32_t u, std::int32_t v) {
      if (x < first || x >= last) return;
      row[x] = raw(std::min<int>((u + 32768) >> 16, raw.width - 1), std::min<int>((v + 32768) >> 16, raw.height - 1));
    });
  }
}

void RectifyImage(ImageView raw, const RectificationMap& map, MutableImageView out) {
  RowScratch scratch;
  for (int y = 0; y < out.height; ++y) {
    const auto [begin, end] = map.valid[static_cast<std::size_t>(y)];
    std::uint8_t* row = out.row(y);
    if (begin == end) {
      std::fill(row, row + out.width, std::uint8_t{0});
      continue;
    }
    ResampleRow(raw, RowCursor{map, y}, begin, end, scratch, row);
    std::fill(row, row + begin, row[begin]);
    std::fill(row + end, row + out.width, row[end - 1]);
  }
}

}  // namespace wirepose
