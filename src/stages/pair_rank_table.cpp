// Written by tools/evaluation/fit_pairs.py; do not edit.
#include "stages/pair_rank.h"

namespace wirepose {

// clang-format off
const PairWeightTable& DefaultPairWeights() {
  static constexpr PairWeightTable kTable = {{
    {-6.638058F, {-1.222525F, 0.3036046F, 0.0F, 0.0F, -2.928513F, 0.0F, 2.656622F, 8.089515F, -1.850994F, 1.852305F, 0.0F, 0.0F, 0.0F, 0.0F, -0.02F, -0.02F, 0.1479466F}},  // flat
    {-13.52048F, {-0.9767091F, 0.7479359F, 0.7978036F, -2.144766F, -0.4168223F, -2.373922F, 3.065971F, 8.239476F, -2.879688F, 1.306F, 3.395258F, -0.7940588F, 11.57977F, -6.612582F, -0.2051131F, -0.8995335F, 0.1427366F}},  // parallel
    {-6.385087F, {-1.135604F, -0.7582372F, 0.3494655F, -1.101803F, -2.104388F, 0.0F, 3.523617F, 7.642831F, -1.404288F, 1.682191F, 9.961936F, -4.587318F, 2.955179F, -0.9667371F, -0.380753F, -0.1796413F, 0.06975218F}},  // corner
    {-15.77132F, {-1.172698F, -0.2634439F, 0.00584042F, -1.505493F, -1.105914F, 0.1285187F, 3.314403F, 11.85706F, -5.375148F, 1.924326F, 6.673338F, -2.876F, 14.70923F, -7.272432F, -0.4638779F, -0.546423F, 0.219971F}},  // apart
  }};
  return kTable;
}
// clang-format on

}  // namespace wirepose
