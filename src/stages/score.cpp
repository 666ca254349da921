#include "stages/score.h"

#include <algorithm>

#include "base/portable_math.h"

namespace wirepose {

float ScoreOf(const ScoreTable& table, std::span<const float> terms) {
  float log_odds = table.bias;
  for (const ScoreTree& tree : table.trees) {
    std::size_t node = 0;
    while (node < ScoreTree::kSplits) {
      const ScoreTree::Split& split = tree.splits[node];
      node = 2 * node + (terms[split.term] > split.threshold ? 2 : 1);
    }
    log_odds += tree.leaves[node - ScoreTree::kSplits];
  }
  return 1 / (1 + Exp(-std::clamp(log_odds, -30.0F, 30.0F)));
}

}  // namespace wirepose
