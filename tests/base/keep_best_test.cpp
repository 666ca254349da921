#include "base/keep_best.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "scored_item.h"

namespace wirepose {
namespace {

using testing::Better;
using testing::Item;

TEST(KeepBest, BelowCapacityKeepsAll) {
  KeepBest<Item, 20, Better> best;
  best.Push({1, 0});
  best.Push({5, 1});
  EXPECT_EQ(best.size(), 2u);
  EXPECT_EQ(best.dropped(), 0u);
  EXPECT_TRUE(best.WouldKeep({-100, 2}));
  EXPECT_EQ(best.Sorted()[0].score, 5);
}

TEST(KeepBest, ClearForgetsDropsToo) {
  KeepBest<Item, 1, Better> best;
  best.Push({1, 0});
  best.Push({2, 1});
  EXPECT_EQ(best.dropped(), 1u);
  best.clear();
  EXPECT_EQ(best.size(), 0u);
  EXPECT_EQ(best.dropped(), 0u);
}

// Against sorting everything; few distinct scores, so that ties are common.
TEST(KeepBest, AgreesWithSorting) {
  std::mt19937 random(3);
  for (int round = 0; round < 500; ++round) {
    KeepBest<Item, 10, Better> best;
    std::vector<Item> all;
    const int count = static_cast<int>(random() % 40);
    for (int id = 0; id < count; ++id) {
      const Item item{static_cast<int>(random() % 6), id};
      std::vector<Item> kept_before = all;
      std::sort(kept_before.begin(), kept_before.end(), Better{});
      const bool better = kept_before.size() < 10 || Better{}(item, kept_before[9]);
      ASSERT_EQ(best.WouldKeep(item), better);
      best.Push(item);
      all.push_back(item);
    }
    std::sort(all.begin(), all.end(), Better{});
    const std::size_t kept = std::min<std::size_t>(all.size(), 10);
    ASSERT_EQ(best.dropped(), all.size() - kept);
    const auto& sorted = best.Sorted();
    ASSERT_EQ(std::vector<Item>(sorted.begin(), sorted.end()),
              std::vector<Item>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kept)));
  }
}

}  // namespace
}  // namespace wirepose
