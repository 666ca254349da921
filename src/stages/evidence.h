// What speaks for and against a pose, and what it is gathered from.
#ifndef WIREPOSE_STAGES_EVIDENCE_H_
#define WIREPOSE_STAGES_EVIDENCE_H_

#include "stages/disparity_map.h"
#include "stages/edge_map.h"
#include "stages/normalize.h"
#include "stages/sample_edges.h"
#include "stages/surface_evidence.h"

namespace wirepose {

struct VerifyParams {
  SampleParams samples{.step_px = 4};
  int piece_samples = 5;     // neighbouring samples of an edge whose profiles are averaged
  float noise_floor = 0.6F;  // grey levels per pixel that an averaged profile may show of nothing
  SurfaceEvidenceParams surface;
  float support_rate = 0.7F;       // share of a true object's visible edge samples that show an edge
  float independent_px = 12;       // samples nearer to each other along an edge repeat what the first one said
  float max_offset_px = 2.2F;      // of a supporting image edge from the model edge, in each image ...
  float max_difference_px = 4.0F;  // ... and between both images
  int face_grid_px = 6;            // spacing of patches on a face
  int max_face_patches = 32;       // per face; the grid widens to fit
  float min_face_px2 = 250;        // smaller faces abstain
};

// What speaks for and against a pose. All terms are log-likelihood ratios up to calibration: 0 abstains.
struct Evidence {
  float edges = 0;          // visible edge samples with and without an image edge, against the frame's background
  float contrast = 0;       // share of samples with an edge minus the same share beside the edges, -1..1
  float distinct = 0;       // how much the edges stand out from what is beside them, in both images, 0..1
  SurfaceEvidence surface;  // of the disparity map
  float faces = 0;          // visible faces predict the right image from the left one, compared with shifted depths
  float overrun = 0;     // share of edge ends beyond which the image edge goes on, 0..1: clutter has no corners there
  float support = 0;     // share of visible edge length in the left image that shows an edge, 0..1
  float inside = 0;      // share of the visible edges that lies in the left image, 0..1
  float visible_px = 0;  // length of visible edges in the left image
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
  const DisparityMap& disparity;
};

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_EVIDENCE_H_
