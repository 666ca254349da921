// Stage 6: the probability that a pose is right, given its evidence.
#ifndef WIREPOSE_STAGES_SCORE_H_
#define WIREPOSE_STAGES_SCORE_H_

#include <array>
#include <cstdint>
#include <span>

#include "stages/evidence.h"

namespace wirepose {

// A complete binary tree. Node n of the splits goes on at 2 n + 1 when the term is at most the threshold, else at
// 2 n + 2; the leaves follow on the splits.
struct ScoreTree {
  static constexpr std::size_t kDepth = 5;
  static constexpr std::size_t kSplits = (1U << kDepth) - 1;

  struct Split {
    std::uint8_t term = 0;  // index of the terms
    float threshold = 0;
  };
  std::array<Split, kSplits> splits;
  std::array<float, kSplits + 1> leaves{};  // log odds
};

struct ScoreTable {
  float bias = 0;  // log odds
  std::span<const ScoreTree> trees;
};

// Gradient boosted trees (Friedman 2001), fitted by tools/evaluation/fit_score.py to simulated scenes of
// sim/scenarios/extra and never to recorded data: one table for all models and cameras. What is known of a term's
// direction is built in: more support never lowers a score.
const ScoreTable& DefaultScoreTable();

// Logistic function of the summed leaves: of what has score s, a share of s is right. `terms`: those that the table was
// fitted to. O(trees).
float ScoreOf(const ScoreTable& table, std::span<const float> terms);

}  // namespace wirepose

#endif  // WIREPOSE_STAGES_SCORE_H_
