// Stage 6: is the object really there? Evidence of edges, faces and silhouette in both images.
#ifndef WIREPOSE_STAGES_VERIFICATION_H_
#define WIREPOSE_STAGES_VERIFICATION_H_

#include "stages/edge_map.h"
#include "stages/normalize.h"
#include "stages/sample_edges.h"

namespace wirepose {

struct VerifyParams {
  SampleParams samples{.step_px = 6};
  float support_rate = 0.7F;    // share of a true object's visible edge samples that show an edge
  float sample_weight = 0.5F;   // neighbouring samples are not independent
  float max_offset_px = 2.2F;   // of a supporting image edge from the model edge, in each image ...
  float max_difference_px = 4.0F;  // ... and between both images
  int face_grid_px = 6;         // spacing of patches on a face
  int max_face_patches = 32;    // per face; the grid widens to fit
  float min_face_px2 = 250;     // smaller faces abstain
};

// What speaks for and against a pose. All terms are log-likelihood ratios up to calibration: 0 abstains.
struct Evidence {
  float edges = 0;        // visible edge samples with and without an image edge, against the frame's background
  float contrast = 0;     // share of samples with an edge minus the same share beside the edges, -1..1
  float faces = 0;        // visible faces predict the right image from the left one, compared with shifted depths
  float overrun = 0;      // share of edge ends beyond which the image edge goes on, 0..1: clutter has no corners there
  float support = 0;      // share of visible edge length in the left image that shows an edge, 0..1
  float inside = 0;       // share of the visible edges that lies in the left image, 0..1
  float visible_px = 0;   // length of visible edges in the left image
  std::uint16_t supported_edges = 0;  // edges with support of more than half
  std::uint16_t supported_faces = 0;  // faces that touch such edges (the paper ranks by lines and faces)
};

struct VerifyInput {
  const RectifiedCamera& camera;
  const EdgeMap& left_edges;
  const EdgeMap& right_edges;
  const NormalizedPlane& left;
  const NormalizedPlane& right;
  const SmoothPlane& left_smooth;
  const SmoothPlane& right_smooth;
};

struct VerifyScratch {
  EdgeSamples samples;
  FrontTriangles front;
};

// Lines place an object but do not decide its presence: random poses reach high support in clutter. So evidence grows
// with length against the frame's background rate, unsupported edges count against, and the same test at places beside
// the edges tells how often mere texture passes it (a-contrario, after LSD: Grompone von Gioi et al. 2012). An edge supports when both images show it, of equal polarity and at equal offset. Each face must
// be photo-consistent at its own depth rather than at others (textured faces vote, blank ones abstain). Image edges that
// overrun the model's corners are counted. What lies outside an image abstains. O(samples * triangles + patches).
void GatherEvidence(const VerifyParams& params, const VerifyInput& input, const PreparedModel& model,
                    const Pose& T_camera_model, VerifyScratch& scratch, Evidence& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_VERIFICATION_H_
