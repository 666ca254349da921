// The coarse score of a pose: do its visible edges find image edges?
#ifndef WIREPOSE_STAGES_POSE_SCORE_H_
#define WIREPOSE_STAGES_POSE_SCORE_H_

#include "geometry/camera.h"
#include "model/prepared_model.h"
#include "stages/edge_map.h"

namespace wirepose {

struct PoseScoreParams {
  float sample_step_px = 6;
  float support_rate = 0.75F;  // share of a true object's visible edge samples that show an edge
  float sample_weight = 0.5F;  // neighbouring samples are not independent
  float min_inside = 0.4F;     // share of the visible edge length that lies in the left image
  // From this many of its longest visible edges on, a pose that has less support so far is given up.
  int first_edges = 6;
  float min_first_support = 0.35F;
};

// What poses are scored against.
struct SceneEdges {
  const RectifiedCamera& camera;
  const EdgeMap& left;
  const EdgeMap& right;
};

// The coarse score of a pose and what it is made of.
struct PoseSupport {
  float score = 0;            // log-likelihood ratio of the edge samples: object at this pose against background
  float left = 0, right = 0;  // shares of the samples inside an image that show an edge; alike without a right image
  int edges = 0;              // that were sampled
};

// Scores many poses of one model in one frame. Cheap to make; holds references to what it was made from.
class PoseScorer {
 public:
  PoseScorer(const PoseScoreParams& params, const SceneEdges& scene, const PreparedModel& model);

  // An edge in the rectified pair: end points in the left image and their disparities.
  struct Projected {
    Vector2 a, b;
    float disparity_a, disparity_b;
  };
  // False when the edge comes too near to the camera plane (5 cm).
  bool Project(const PreparedEdge& edge, const Matrix3& R, const Vector3& t, Projected& out) const;

  // Support of the visible edges in both images, object at (R, t). False when too little of the object lies in the
  // image, its longest edges already fail or the left image speaks against it. `visible` are the edges to score.
  bool Score(const Matrix3& R, const Vector3& t, const EdgeBits& visible, PoseSupport& out) const;

  [[nodiscard]] const SceneEdges& scene() const { return scene_; }

 private:
  struct LogGain {
    float hit, miss;
  };
  struct Support {
    float sum = 0;
    int hits = 0, inside = 0;

    [[nodiscard]] float Share() const {
      return inside > 0 ? static_cast<float>(hits) / static_cast<float>(inside) : 0.0F;
    }
  };
  [[nodiscard]] LogGain Gain(const EdgeMap& map) const;
  static void AddSupport(const EdgeMap& map, const LogGain& gain, const Vector2& a, const Vector2& b, int n,
                         Support& out);

  const PoseScoreParams& params_;
  const SceneEdges& scene_;
  const PreparedModel& model_;
  float f_, cx_, cy_, fb_;
  LogGain left_gain_{}, right_gain_{};
};

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_POSE_SCORE_H_
