// Rendered stereo pairs without distortion, for the stages that look at pictures: the truth is
// exact.
#ifndef WIREPOSE_TESTS_STAGES_RENDERED_SCENE_H_
#define WIREPOSE_TESTS_STAGES_RENDERED_SCENE_H_

#include "model_test_support.h"
#include "sim/renderer.h"
#include "sim/sensor.h"

namespace wirepose::testing {

struct RenderedScene {
  RectifiedCamera camera;
  std::unique_ptr<Planes> left, right;
};

// The mesh of a model, so that what is rendered is what is searched for.
inline sim::Mesh MeshOf(const ModelView& model) {
  sim::Mesh mesh;
  for (std::size_t i = 0; i < model.vertices.size(); ++i) mesh.vertices.push_back(model.VertexPosition(i));
  for (const ModelTriangle& t : model.triangles) mesh.triangles.push_back({t.vertex[0], t.vertex[1], t.vertex[2]});
  return mesh;
}

// The object in front of a speckled wall 0.5 m behind it, under one lamp. `texture` of the object;
// 320 x 240 pixels, since rendering is what takes time. The left camera is the origin.
inline RenderedScene Render(const ModelView& model, const Pose& T_camera_model, sim::Texture texture,
                            std::uint64_t seed, const RectifiedCamera& camera) {
  sim::Scene scene;
  scene.meshes = {MeshOf(model), sim::MakeBox({4, 4, 0.01F})};
  sim::Instance object, wall;
  object.mesh = 0;
  object.T_world_object = T_camera_model;
  object.material.texture = texture;
  object.material.albedo = 0.75F;
  object.material.second_albedo = 0.3F;
  object.material.seed = static_cast<std::uint32_t>(seed);
  wall.mesh = 1;
  wall.T_world_object.t = {0, 0, T_camera_model.t.z() + 0.5};
  wall.material.texture = sim::Texture::kStone;
  wall.material.scale_m = 0.04F;
  wall.material.albedo = 0.25F;
  scene.instances = {object, wall};
  // From the upper left behind the camera, so that faces differ in brightness.
  scene.lights = {{{-0.8F, -1.0F, 0}, {0.2F, 0, 0}, {0, 0.1F, 0.17F}, 1.5F}};
  const sim::Renderer renderer(scene);
  const auto shoot = [&](double x, std::uint64_t noise) {
    sim::Camera eye;
    eye.intrinsics = {camera.f, camera.f, camera.cx, camera.cy};
    eye.width = camera.width;
    eye.height = camera.height;
    eye.T_world_camera.t = {x, 0, 0};
    const sim::RadianceImage light = renderer.Render(eye, {.samples_per_side = 3, .threads = 1, .seed = seed + noise});
    return FindAll(sim::Expose(light, 1.2F * sim::AutoExposure(light, 0.7F), {}, noise));
  };
  return {camera, shoot(0, 1), shoot(camera.baseline, 2)};
}

inline RectifiedCamera SmallCamera() {
  RectifiedCamera camera = TestCamera(320, 240);
  camera.f = 350;
  return camera;
}

// The box with three faces in view, 0.7 m away, and a little different each time.
inline Pose GoodView(Random& random, const PreparedModel& model, double z = 0.75) {
  Pose T;
  T.R = ExpSo3({0.08 * Gaussian(random), 0.08 * Gaussian(random), 0.08 * Gaussian(random)}) * ExpSo3({0.5, 0, 0}) *
        ExpSo3({0, 0.6, 0}) * (Matrix3d() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished();
  T.t = Vector3d(0.02 * Gaussian(random), 0.02 * Gaussian(random), z) - T.R * model.centre.cast<double>();
  return T;
}

// Turned by `angle_rad` about a random axis and moved by `distance_m` in a random direction.
inline Pose Shaken(Random& random, const Pose& T, double angle_rad, double distance_m) {
  Vector6d twist;
  twist << angle_rad * AnyDirection(random), distance_m * AnyDirection(random);
  return PerturbLeft(T, twist, T.t);
}

// Greatest distance in the left image of a box corner's projection from where it should be, px.
inline double PixelError(const RectifiedCamera& camera, const PreparedModel& model, const Pose& estimate,
                         const Pose& truth) {
  double worst = 0;
  for (const Vector3& corner : model.corners) {
    const Vector3d c = corner.cast<double>();
    worst = std::max(worst, (camera.Project(estimate * c) - camera.Project(truth * c)).head<2>().norm());
  }
  return worst;
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_STAGES_RENDERED_SCENE_H_
