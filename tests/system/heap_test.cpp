// wireposed asks for no heap and waits for no page from the disk once it runs. What DDS allocates on its own threads
// and the publisher's is printed, not judged.
#include <fstream>

#include "robot_test_base.h"

namespace wirepose::test {
namespace {

struct Use {
  long main = 0, others = 0, minor_faults = 0, major_faults = 0;
};

class HeapTest : public RobotTest {
 protected:
  // The section of the configuration for twelve frames over and over.
  [[nodiscard]] static std::string SimulatedCamera(int rate_hz) {
    const std::string meshes = std::filesystem::path(WIREPOSE_MESH).parent_path().string();
    return "camera:\n  backend: simulated\n  simulated: { meshes: " + meshes +
           ", calibration: data/calib.yaml, frames: 0, loop_frames: 12, samples_per_pixel: 4, frame_rate_hz: " +
           std::to_string(rate_hz) + " }\n";
  }

  // `camera`: the section of the configuration.
  [[nodiscard]] Use Run(const std::string& camera, int frames) const {
    const std::string config =
        WriteConfig(camera + "dds: { domain: " + domain_ + ", loopback: true }\nmodels: [parcel_box.wpm]\n");
    const std::string file = (folder_ / "use.txt").string();
    Process robot(
        folder_, "robot", Robot(config, {"--frames", std::to_string(frames)}),
        {std::string("LD_PRELOAD=") + WIREPOSE_HEAP_COUNTER, "WIREPOSE_HEAP_COUNT=" + file, "WATCHDOG_USEC=100000"});
    EXPECT_EQ(robot.Wait(std::chrono::seconds(250)), 0) << robot.Err();
    Use use;
    std::string word;
    std::ifstream(file) >> word >> use.main >> word >> use.others >> word >> use.minor_faults >> word >>
        use.major_faults;
    EXPECT_EQ(word, "major_faults") << "the counter was not loaded, or wireposed is built without libsystemd";
    return use;
  }
};

TEST_F(HeapTest, TenThousandFramesWithoutHeapOnTheThreadThatRecognizes) {
  WriteDataset(4);
  const Use use = Run("camera:\n  backend: replay\n  replay: { data_set: data, loop: true, preload: true }\n", 10'000);
  EXPECT_EQ(use.main, 0);
  EXPECT_EQ(use.major_faults, 0);
  std::printf(
      "10,000 frames: %ld heap calls on the thread that captures and recognizes, %ld on the publisher's and DDS's, "
      "%ld minor and %ld major page faults\n",
      use.main, use.others, use.minor_faults, use.major_faults);
}

// Twelve frames are rendered while the first ones are recognized, and come again and again. What renders is the
// simulated camera's own thread, counted among the others.
TEST_F(HeapTest, SimulatedFeedWithoutHeapOnTheThreadThatRecognizes) {
  WriteDataset(1);
  const Use use = Run(SimulatedCamera(100), 300);
  EXPECT_EQ(use.main, 0);
  EXPECT_EQ(use.major_faults, 0);
}

TEST_F(HeapTest, LongTenThousandSimulatedFramesWithoutHeapOnTheThreadThatRecognizes) {
  WriteDataset(1);
  const Use use = Run(SimulatedCamera(500), 10'000);
  EXPECT_EQ(use.main, 0);
  EXPECT_EQ(use.major_faults, 0);
  std::printf(
      "10,000 simulated frames: %ld heap calls on the thread that captures and recognizes, %ld on the camera's, the "
      "publisher's and DDS's, %ld minor and %ld major page faults\n",
      use.main, use.others, use.minor_faults, use.major_faults);
}

}  // namespace
}  // namespace wirepose::test
