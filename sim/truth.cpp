#include "sim/truth.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "sim/lens.h"
#include "sim/parallel.h"

namespace wirepose::sim {
namespace {

// A rectangle of whole pixels, both ends included.
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;
};

class Observer {
 public:
  Observer(const Renderer& renderer, const Camera& camera, int threads)
      : renderer_(renderer),
        camera_(camera),
        lens_(camera.intrinsics),
        origin_(camera.T_world_camera.t.cast<float>()),
        threads_(threads) {
    CastCentres();
  }

  Truth See() const {
    Truth truth;
    truth.width = camera_.width;
    truth.height = camera_.height;
    truth.depth_m.assign(directions_.size(), 0.0F);
    truth.instance.assign(directions_.size(), -1);
    ForEachRow(camera_.height, threads_, [&](int y) {
      for (int x = 0; x < camera_.width; ++x) {
        const std::size_t i = Index(x, y);
        if (directions_[i].isZero()) continue;
        const RayScene::Hit hit = renderer_.rays().Intersect(origin_, directions_[i]);
        if (hit.instance == RayScene::kNothing) continue;
        // Directions have z = 1 in the camera, so the ray parameter is the depth.
        truth.depth_m[i] = hit.t;
        truth.instance[i] = static_cast<std::int16_t>(hit.instance);
      }
    });
    const std::vector<Instance>& instances = renderer_.scene().instances;
    for (std::size_t i = 0; i < instances.size(); ++i) {
      if (instances[i].obj_id > 0) truth.objects.push_back(Object(static_cast<int>(i), truth));
    }
    return truth;
  }

 private:
  [[nodiscard]] std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) + static_cast<std::size_t>(x);
  }

  [[nodiscard]] Vector3 ToWorld(const Vector2d& xy) const {
    return (camera_.T_world_camera.R * Vector3d(xy.x(), xy.y(), 1)).cast<float>();
  }

  // The direction of every pixel's centre, in the world; zero where the lens has none.
  void CastCentres() {
    directions_.resize(static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height));
    ForEachRow(camera_.height, threads_, [&](int y) {
      for (int x = 0; x < camera_.width; ++x) {
        const std::optional<Lens::Ray> ray = lens_.RayOf(Vector2d(x, y));
        directions_[Index(x, y)] = ray ? ToWorld(ray->xy) : Vector3(Vector3::Zero());
      }
    });
  }

  ObjectTruth Object(int index, const Truth& truth) const {
    const Instance& instance = renderer_.scene().instances[static_cast<std::size_t>(index)];
    ObjectTruth object;
    object.instance = index;
    object.obj_id = instance.obj_id;
    object.name = instance.name;
    object.T_camera_object = camera_.T_world_camera.Inverse() * instance.T_world_object;
    CountVisible(truth, object);
    object.px_count_in_image = CountInImage(index);
    object.px_count_all = object.px_count_in_image + CountOutside(index, object.T_camera_object);
    if (object.px_count_all > 0) {
      object.visib_fract = double(object.px_count_visib) / object.px_count_all;
    }
    return object;
  }

  void CountVisible(const Truth& truth, ObjectTruth& object) const {
    PixelBox box{camera_.width, camera_.height, -1, -1};
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        if (truth.instance[Index(x, y)] != object.instance) continue;
        ++object.px_count_visib;
        box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x), std::max(box.y1, y)};
      }
    }
    if (object.px_count_visib == 0) return;
    object.bbox_visib = {box.x0, box.y0, box.x1 - box.x0 + 1, box.y1 - box.y0 + 1};
  }

  [[nodiscard]] int CountInImage(int index) const {
    std::atomic<int> count{0};
    ForEachRow(camera_.height, threads_, [&](int y) {
      int in_row = 0;
      for (int x = 0; x < camera_.width; ++x) {
        const Vector3& direction = directions_[Index(x, y)];
        if (direction.isZero()) continue;
        in_row += renderer_.rays().MeetsAlone(index, origin_, direction) ? 1 : 0;
      }
      count += in_row;
    });
    return count;
  }

  // The pixels of an undistorted image, as wide as it takes, that the object covers and the raw
  // image does not show.
  [[nodiscard]] int CountOutside(int index, const Pose& T_camera_object) const {
    const CameraIntrinsics& c = camera_.intrinsics;
    const PixelBox box = PinholeBox(index, T_camera_object);
    std::atomic<int> count{0};
    ForEachRow(std::max(box.y1 - box.y0 + 1, 0), threads_, [&](int row) {
      int in_row = 0;
      for (int u = box.x0; u <= box.x1; ++u) {
        const Vector2d xy((u - c.cx) / c.fx, (row + box.y0 - c.cy) / c.fy);
        if (!IsInRawImage(xy) && renderer_.rays().MeetsAlone(index, origin_, ToWorld(xy))) ++in_row;
      }
      count += in_row;
    });
    return count;
  }

  [[nodiscard]] bool IsInRawImage(const Vector2d& xy) const {
    const Vector2d pixel = lens_.PixelOf(xy);
    if (pixel.x() < -0.5 || pixel.y() < -0.5 || pixel.x() >= camera_.width - 0.5 || pixel.y() >= camera_.height - 0.5) {
      return false;
    }
    // Beyond the lens polynomial's fold directions come back into the image; they are not seen
    // there.
    const std::optional<Lens::Ray> seen = lens_.RayOf(pixel);
    return seen && (seen->xy - xy).norm() < 1e-6;
  }

  // Around the object in the undistorted image, at most two image widths beyond the image; all of
  // that when a part of the object is not in front of the camera.
  [[nodiscard]] PixelBox PinholeBox(int index, const Pose& T_camera_object) const {
    const Scene& scene = renderer_.scene();
    const Instance& instance = scene.instances[static_cast<std::size_t>(index)];
    const CameraIntrinsics& c = camera_.intrinsics;
    const PixelBox widest{-2 * camera_.width, -2 * camera_.height, 3 * camera_.width, 3 * camera_.height};
    double x0 = widest.x1, y0 = widest.y1, x1 = widest.x0, y1 = widest.y0;
    bool is_behind = false, is_in_front = false;
    for (const Vector3& vertex : scene.meshes[static_cast<std::size_t>(instance.mesh)].vertices) {
      const Vector3d p = T_camera_object * vertex.cast<double>();
      if (p.z() < 0.02) {
        is_behind = true;
        continue;
      }
      is_in_front = true;
      const double u = c.fx * p.x() / p.z() + c.cx, v = c.fy * p.y() / p.z() + c.cy;
      x0 = std::min(x0, u);
      x1 = std::max(x1, u);
      y0 = std::min(y0, v);
      y1 = std::max(y1, v);
    }
    if (!is_in_front) return {};
    if (is_behind) return widest;
    const auto clamp = [](double value, int low, int high) {
      return static_cast<int>(std::clamp(value, double(low), double(high)));
    };
    return {clamp(std::floor(x0), widest.x0, widest.x1), clamp(std::floor(y0), widest.y0, widest.y1),
            clamp(std::ceil(x1), widest.x0, widest.x1), clamp(std::ceil(y1), widest.y0, widest.y1)};
  }

  const Renderer& renderer_;
  const Camera& camera_;
  Lens lens_;
  Vector3 origin_;
  int threads_;
  std::vector<Vector3> directions_;
};

}  // namespace

Truth FindTruth(const Renderer& renderer, const Camera& camera, int threads) {
  return Observer(renderer, camera, threads).See();
}

}  // namespace wirepose::sim
