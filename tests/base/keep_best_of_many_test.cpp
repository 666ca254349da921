#include "base/keep_best_of_many.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "scored_item.h"

namespace wirepose {
namespace {

using testing::Better;
using testing::Item;

using Best = KeepBestOfMany<Item, 10, Better>;

// Against sorting everything; few distinct scores, so that ties are common. What it claims on the way must hold:
// nothing that may not be kept is among the best.
TEST(KeepBestOfMany, AgreesWithSorting) {
  std::mt19937 random(3);
  for (int round = 0; round < 2000; ++round) {
    Best best;
    std::vector<Item> all;
    const int count = static_cast<int>(random() % 80);
    for (int id = 0; id < count; ++id) {
      const Item item{static_cast<int>(random() % 6), id};
      if (!best.MayKeep(item)) {
        const auto better = std::count_if(all.begin(), all.end(), [&](const Item& a) { return Better{}(a, item); });
        ASSERT_GE(better, 10);
      }
      best.Push(item);
      all.push_back(item);
    }
    std::sort(all.begin(), all.end(), Better{});
    const auto kept = std::min<std::ptrdiff_t>(std::ssize(all), 10);
    const auto sorted = best.Sorted();
    ASSERT_EQ(std::vector<Item>(sorted.begin(), sorted.end()), std::vector<Item>(all.begin(), all.begin() + kept));
    ASSERT_EQ(best.dropped(), all.size() - static_cast<std::size_t>(kept));
    ASSERT_EQ(best.items().size(), static_cast<std::size_t>(kept));
  }
}

TEST(KeepBestOfMany, KeepsEverythingUntilItWasFull) {
  Best best;
  for (int id = 0; id < 14; ++id) best.Push({id, id});
  EXPECT_FALSE(best.worst());
  EXPECT_TRUE(best.MayKeep({-100, 0}));
  best.Push({14, 14});
  ASSERT_TRUE(best.worst());
  EXPECT_EQ(best.worst()->score, 5);
  EXPECT_FALSE(best.MayKeep({5, 99}));
  EXPECT_TRUE(best.MayKeep({6, 99}));
}

TEST(KeepBestOfMany, CountsWhatWasNeverMade) {
  Best best;
  best.CountDropped(7);
  EXPECT_EQ(best.dropped(), 7U);
  best.clear();
  EXPECT_EQ(best.dropped(), 0U);
  EXPECT_TRUE(best.Sorted().empty());
}

}  // namespace
}  // namespace wirepose
