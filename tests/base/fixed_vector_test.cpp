#include "base/fixed_vector.h"

#include <gtest/gtest.h>

#include <random>
#include <span>
#include <vector>

namespace wirepose {
namespace {

TEST(FixedVector, ZeroOneMany) {
  FixedVector<int, 3> v;
  EXPECT_TRUE(v.empty());
  EXPECT_EQ(v.begin(), v.end());
  EXPECT_TRUE(v.try_push_back(1));
  EXPECT_EQ(v.size(), 1u);
  EXPECT_EQ(v.front(), 1);
  EXPECT_EQ(v.back(), 1);
  v.push_back(2);
  v.push_back(3);
  EXPECT_TRUE(v.full());
  EXPECT_EQ(v.back(), 3);
}

TEST(FixedVector, AFullVectorRefusesAndStaysAsItWas) {
  FixedVector<int, 2> v;
  v.push_back(1);
  v.push_back(2);
  EXPECT_FALSE(v.try_push_back(3));
  EXPECT_EQ(v.size(), 2u);
  EXPECT_EQ(v[1], 2);
}

TEST(FixedVector, ConvertsToSpan) {
  FixedVector<int, 4> v;
  v.push_back(5);
  v.push_back(6);
  const std::span<const int> span(v.data(), v.size());
  EXPECT_EQ(span.size(), 2u);
  EXPECT_EQ(span[1], 6);
  const std::span<const int> converted = v;
  EXPECT_EQ(converted.data(), v.data());
  EXPECT_EQ(converted.size(), 2u);
}

TEST(FixedVector, WorksAtCompileTime) {
  constexpr int kSum = [] {
    FixedVector<int, 3> v;
    v.push_back(20);
    v.push_back(22);
    int sum = 0;
    for (const int i : v) sum += i;
    return sum;
  }();
  static_assert(kSum == 42);
}

TEST(FixedVectorDeathTest, HaltsOnBrokenPromises) {
  FixedVector<int, 1> v;
  EXPECT_DEATH(v.pop_back(), "");
  EXPECT_DEATH(v.resize(2), "");
  v.push_back(1);
  EXPECT_DEATH(v.push_back(2), "");
}

TEST(FixedVector, AgreesWithVector) {
  std::mt19937 random(5);
  FixedVector<unsigned, 9> v;
  std::vector<unsigned> oracle;
  for (int step = 0; step < 20000; ++step) {
    switch (random() % 8) {
      case 0:
        if (!oracle.empty()) {
          v.pop_back();
          oracle.pop_back();
        }
        break;
      case 1:
        if (random() % 8 == 0) {
          v.clear();
          oracle.clear();
        }
        break;
      case 2: {
        const std::size_t size = random() % (oracle.size() + 1);
        v.resize(size);
        oracle.resize(size);
        break;
      }
      default: {
        const auto value = static_cast<unsigned>(random());
        ASSERT_EQ(v.try_push_back(value), oracle.size() < 9);
        if (oracle.size() < 9) oracle.push_back(value);
      }
    }
    ASSERT_EQ(std::vector<unsigned>(v.begin(), v.end()), oracle);
  }
}

}  // namespace
}  // namespace wirepose
