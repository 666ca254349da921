// Stage 5c: which promoted line sets lie near an object, and are worth an adjustment.
#ifndef WIREPOSE_STAGES_SET_RANK_H_
#define WIREPOSE_STAGES_SET_RANK_H_

#include <array>

#include "stages/score.h"

namespace wirepose {

// What is known of a promoted set before its pose is adjusted: little, and cheap.
struct SetEvidence {
  float score = 0;             // coarse score of the aligned pose
  float score_share = 0;       // of the best coarse score among the model's sets in this frame
  float left = 0, right = 0;   // shares of the samples of visible edges that find support; alike without a right image
  float edges = 0;             // visible edges in the image
  float lines = 0;             // of these, with a line of the set
  float depth_share = 0;       // of the visible edges' length: lines of the set with depth
  float residual_px = 0;       // mean distance of the set's lines from their edges
  float disparity_misfit = 0;  // mean difference of their disparities, in standard deviations
  float overrun = 0;           // of the ends of long visible edges: image edges go on beyond them
  float hypotheses = 0;        // that led to this pose
};

inline constexpr std::size_t kSetTerms = 11;
using SetTerms = std::array<float, kSetTerms>;

// The evidence as the rank reads it, and the names of the terms in that order.
SetTerms TermsOf(const SetEvidence& evidence);
const std::array<const char*, kSetTerms>& SetTermNames();

// Boosted trees as of the score, fitted by tools/evaluation/fit_score.py to sets of the same scenes: the probability
// that the pose lies within 0.15 diameters of an object's, from where the adjustment finds it.
const ScoreTable& DefaultRankTable();

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_SET_RANK_H_
