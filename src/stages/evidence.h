// What speaks for and against a pose, and what it is gathered from.
#ifndef WIREPOSE_STAGES_EVIDENCE_H_
#define WIREPOSE_STAGES_EVIDENCE_H_

#include <array>
#include <span>

#include "stages/disparity_map.h"
#include "stages/edge_map.h"
#include "stages/ground_evidence.h"
#include "stages/line_evidence.h"
#include "stages/occlusion.h"
#include "stages/rival_evidence.h"
#include "stages/sample_edges.h"
#include "stages/surface_evidence.h"

namespace wirepose {

struct VerifyParams {
  SampleParams samples{.step_px = 4};
  OcclusionParams occlusion;
  SurfaceEvidenceParams surface;
  LineEvidenceParams lines;
  GroundEvidenceParams ground;
  RivalEvidenceParams rivals;
  int piece_samples = 5;           // neighbouring samples of an edge whose profiles are averaged
  float noise_floor = 0.6F;        // grey levels per pixel that an averaged profile may show of nothing
  float max_offset_px = 2.2F;      // of a supporting image edge from the model edge, in each image ...
  float max_difference_px = 4.0F;  // ... and between both images
  float sharp_offset_px = 0.8F;    // support this close is sharp: refinement brings a true pose that near
  float min_edge_px = 20;          // visible; what is shorter has no say in shares of edges
};

// Support of the visible edges by image edges. Shares are of samples or lengths, 0..1.
struct EdgeEvidence {
  float visible_px = 0;        // length of the edges that face the camera, are not hidden and lie in the left image
  float inside = 0;            // share of the edges that lies in the left image
  float edges = 0;             // how many are longer than min_edge_px
  float support = 0;           // share of samples where both images show an edge
  float chance = 0;            // the same share 6 and 10 px beside: what mere texture gives
  float sharp = 0;             // share of samples with sharp support
  float sharp_of_support = 0;  // share of the supported ones that are sharp
  float spread_px = 0;         // standard deviation of the supporting offsets within an edge
  float parallax_px = 0;       // rms difference of both images' offsets, without what a common disparity explains
  float full_edges = 0;        // share of edges with support of more than four fifths
  float weak_edges = 0;        // and of less than two fifths
  float weakest_edge = 0;      // lowest support of an edge
  float distinct = 0;          // how much averaged edges stand out from what is beside them, in both images
  float clear = 0;             // share of the length where they stand out by more than half
  float dimmest_edge = 0;      // lowest distinctness of an edge
  float outline = 0;           // support of the edges behind which the background begins
  float outline_distinct = 0;  // and how much they stand out
  float inner_distinct = 0;    // how much the edges between two visible faces stand out
  float ends = 0;              // share of edge ends next to which most samples have support
  float corners = 0;           // share of corners all of whose edges have such ends
  float weakest_face = 0;      // lowest support of the edges around a visible face
  float overrun = 0;           // share of edge ends beyond which the image edge goes on: clutter has no corners there
  float crossed = 0;           // share of edges that such edges cross at both ends: a face of something larger
};

// All that is known of a pose before it is scored.
struct Evidence {
  EdgeEvidence edges;
  float hidden = 0;         // share of the visible edges' length before which something nearer stands
  LineEvidence lines;       // of the left image's segments, against the model's edges and silhouette
  SurfaceEvidence surface;  // of the disparity map, inside the silhouette and beside it
  float disparity_px = 0;   // of the object's edges, mean: how well depth can be told
  float rms_px = 0;         // what the refinement left
  float shift_px = 0;       // length of the right image's estimated shift against the left one
  float uncertainty = 0;    // of the position by what the visible edges determine, over the diameter
  GroundEvidence ground;    // of the disparity map, around what the object may stand on
  RivalEvidence rivals;     // of image edges at other sizes and poses
};

inline constexpr std::size_t kEvidenceTerms = 54;
using EvidenceTerms = std::array<float, kEvidenceTerms>;

// The terms in a fixed order, as the score reads them, and their names in that order.
EvidenceTerms TermsOf(const Evidence& evidence);
const std::array<const char*, kEvidenceTerms>& EvidenceTermNames();

struct VerifyInput {
  const RectifiedCamera& camera;
  const EdgeMap& left_edges;
  const EdgeMap& right_edges;
  const SmoothPlane& left_smooth;
  const SmoothPlane& right_smooth;
  const DisparityMap& disparity;
  std::span<const Segment2> segments;  // of the whole left image
};

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_EVIDENCE_H_
