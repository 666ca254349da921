#include "base/work_budget.h"

#include <gtest/gtest.h>

namespace wirepose {
namespace {

TEST(WorkBudget, GivesExactlyItsSteps) {
  WorkBudget budget(5);
  EXPECT_TRUE(budget.Spend(2));
  EXPECT_TRUE(budget.Spend(3));
  EXPECT_EQ(budget.left(), 0U);
  EXPECT_FALSE(budget.hit()) << "all spent, nothing refused";
  EXPECT_FALSE(budget.Spend(1));
  EXPECT_TRUE(budget.hit());
}

TEST(WorkBudget, StaysHitAlthoughSmallerRequestsWouldFit) {
  WorkBudget budget(5);
  EXPECT_FALSE(budget.Spend(6));
  EXPECT_FALSE(budget.Spend(1));
  EXPECT_EQ(budget.left(), 5U);
}

TEST(WorkBudget, NothingIsFree) {
  WorkBudget budget(0);
  EXPECT_FALSE(budget.Spend(1));
}

}  // namespace
}  // namespace wirepose
