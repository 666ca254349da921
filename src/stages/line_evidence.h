// Stage 6: what the image's segments say about a pose, beyond the edges that support it.
#ifndef WIREPOSE_STAGES_LINE_EVIDENCE_H_
#define WIREPOSE_STAGES_LINE_EVIDENCE_H_

#include <span>

#include "geometry/camera.h"
#include "geometry/segment2.h"
#include "model/prepared_model.h"
#include "stages/sample_edges.h"
#include "stages/surface_map.h"

namespace wirepose {

struct LineEvidenceParams {
  float min_edge_px = 12;      // visible part of a model edge; what is shorter asks nothing
  float min_cosine = 0.35F;    // to the edge's normal: flatter segments do not cross it
  float corner_px = 5;         // crossings nearer to an end of the edge may be another edge's
  float cross_px = 5;          // a crossing segment reaches this far to both sides
  float touch_px = 4;          // one that ends at the edge comes this near ...
  float leave_px = 8;          // ... and reaches this far to one side
  float along_cosine = 0.12F;  // to the edge's normal: steeper segments do not lie along it
  float along_px = 4;          // distance from the edge of what lies along it, at both ends ...
  float middle_px = 2.5F;      // ... and in its middle
  float along_share = 0.3F;    // of the segment that lies beside the edge
};

// Lines of the world end where an object begins to hide them, and the lines of its print end where it does. A pose on
// some lines of a larger face, a tiling or a wall is crossed by others, and those it stands on go on beyond it.
struct LineEvidence {
  float crossing = 0;         // share of the segments that meet the outline which cross it
  float crossings = 0;        // such segments for every 100 px of outline
  float inner_crossings = 0;  // and across edges between two visible faces, for every 100 px of those
  float beyond = 0;           // length by which segments along an edge go on beyond its ends, over that along it
  float within = 0;           // length of the segments inside of the silhouette, over the length of the visible edges
  float across = 0;           // length of those partly inside, over the same
  float contained = 0;        // share of the former in both
};

// `segments`: of the whole rectified left image, px; `samples`: of the edges that are seen at T_camera_model (rectified
// left camera), in the order of edges; `surface`: the silhouette there. Few segments count for little: shares are
// diluted by two segments or 50 px, `beyond` by 25 px, numbers per 100 px by 100 px. Nothing seen gives zeros. No heap.
// O(edges * segments).
void GatherLineEvidence(const LineEvidenceParams& params, const RectifiedCamera& camera,
                        std::span<const Segment2> segments, const PreparedModel& model, const Pose& T_camera_model,
                        const EdgeSamples& samples, const SurfaceMap& surface, LineEvidence& out);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_LINE_EVIDENCE_H_
