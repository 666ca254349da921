// A publisher whose pool is watched, under stress.
#ifndef WIREPOSE_TESTS_PUBLISH_STRESS_TEST_BASE_H_
#define WIREPOSE_TESTS_PUBLISH_STRESS_TEST_BASE_H_

#include "bus_test_base.h"
#include "publish/dds_pool.h"

namespace wirepose::test {

class StressTest : public BusTest {
 protected:
  void SetUp() override {
    BusTest::SetUp();
    OpenPublisher();
    report_ = RandomReport(random_, 4);
  }

  [[nodiscard]] static std::size_t UsedKib() { return DdsPoolUse().used >> 10; }

  // Still publishes to who comes now.
  void ExpectHealthy() {
    const auto subscriber = Subscribe({"recognition"});
    EXPECT_TRUE(WaitForData(*subscriber, report_));
    EXPECT_EQ(Finish(*subscriber).size(), 1u);
    EXPECT_EQ(publisher_->write_errors(), 0u);
    EXPECT_LT(DdsPoolUse().high_water, DdsPoolUse().capacity * 9 / 10);
  }

  FrameReport report_;
};

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_PUBLISH_STRESS_TEST_BASE_H_
