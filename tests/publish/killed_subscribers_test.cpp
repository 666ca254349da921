// Subscribers that die without a word must not cost memory for long.
#include <algorithm>

#include "stress_test_base.h"

namespace wirepose {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Of the pool: half of what one dead subscriber takes; what the first of them make grow.
constexpr std::size_t kFlat_kib = 12;
constexpr std::size_t kGrowth_kib = 140;

class KilledSubscribersTest : public test::StressTest {
 protected:
  struct Deaths {
    int count = 0;
    milliseconds pause{};  // between two
    seconds lease{};
    std::string settings;  // of the subscribers
  };

  void Kill(const Deaths& deaths) {
    for (int i = 0; i < deaths.count; ++i) {
      const auto subscriber = Subscribe({"detections", "recognition"}, {"CYCLONEDDS_URI=" + deaths.settings});
      ASSERT_TRUE(WaitForData(*subscriber, report_)) << "subscriber " << i;
      subscriber->Signal(SIGKILL);
      Publish(static_cast<int>(deaths.pause / milliseconds(10)), report_, milliseconds(10));
    }
  }

  // The lowest use while the leases of the dead run out; ends at once when it is no more than `enough_kib`.
  std::size_t LowestUseKib(seconds lease, std::size_t enough_kib = 0) {
    std::size_t lowest = UsedKib();
    (void)WaitUntil(
        [&] {
          publisher_->Publish(report_);
          lowest = std::min(lowest, UsedKib());
          return lowest <= enough_kib;
        },
        lease + seconds(2));
    return lowest;
  }

  // Some die, and as many again. The first make Cyclone's tables and lists of free messages grow; those stay, up to a
  // bound (docs/dds.md, memory). The others must leave nothing, but what a list still had room for.
  void KillSubscribers(const Deaths& deaths) {
    ExpectHealthy();
    const std::size_t before = UsedKib();
    Kill(deaths);
    const std::size_t first = LowestUseKib(deaths.lease);
    Kill(deaths);
    const std::size_t second = LowestUseKib(deaths.lease, first + kFlat_kib);
    std::printf("%d killed, twice: %zu KiB before, %zu after the first, %zu after the second, %zu at most\n",
                deaths.count, before, first, second, DdsPoolUse().high_water >> 10);
    EXPECT_LE(first, before + kGrowth_kib);
    EXPECT_LE(second, first + kFlat_kib) << "the dead are not forgotten";
    ExpectHealthy();
  }
};

// A short lease, for the time that the test takes.
TEST_F(KilledSubscribersTest, AreForgotten) {
  KillSubscribers(
      {20, milliseconds(100), seconds(2),
       "<CycloneDDS><Domain><Discovery><LeaseDuration>2 s</LeaseDuration></Discovery></Domain></CycloneDDS>"});
}
// DDS's default lease.
TEST_F(KilledSubscribersTest, LongFiftyAreForgotten) { KillSubscribers({50, milliseconds(500), seconds(10), ""}); }

}  // namespace
}  // namespace wirepose
