// A publisher in this process, and subscribers in others.
#ifndef WIREPOSE_TESTS_PUBLISH_BUS_TEST_BASE_H_
#define WIREPOSE_TESTS_PUBLISH_BUS_TEST_BASE_H_

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "../dds_domain.h"
#include "../system/process.h"
#include "publish/publisher.h"
#include "reports_for_test.h"

namespace wirepose::test {

class BusTest : public ::testing::Test {
 protected:
  using Clock = std::chrono::steady_clock;

  void SetUp() override {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / ("wirepose_" + std::to_string(getpid()) + "_" + info->name());
    std::filesystem::create_directories(folder_);
    config_.bus.domain = domain_.id();
    config_.bus.loopback = true;
    config_.frame_id = "left_optical";
    config_.version = "9.8.7";
  }
  void TearDown() override {
    publisher_->Close();
    std::filesystem::remove_all(folder_);
  }

  void OpenPublisher() {
    const auto opened = publisher_->Open(config_);
    ASSERT_TRUE(opened) << opened.error();
  }

  // A subscriber to `topics`; once it has data, it says so.
  std::unique_ptr<Process> Subscribe(const std::vector<std::string>& topics,
                                     const std::vector<std::string>& environment = {}) {
    std::vector<std::string> command = {WIREPOSE_TEST_SUBSCRIBER, std::to_string(domain_.id())};
    command.insert(command.end(), topics.begin(), topics.end());
    return std::make_unique<Process>(folder_, "subscriber" + std::to_string(++started_), command, environment);
  }
  // Publishes until it has data.
  bool WaitForData(const Process& subscriber, const FrameReport& report) {
    return WaitUntil([&] {
      publisher_->Publish(report);
      return subscriber.Out().find("data") != std::string::npos;
    });
  }
  // Ends it: what it counted, by topic. Empty when it did not end well.
  static std::map<std::string, nlohmann::json> Finish(Process& subscriber) {
    subscriber.Signal(SIGTERM);
    if (subscriber.Wait() != 0) {
      ADD_FAILURE() << "the subscriber did not end well: " << subscriber.Err();
      return {};
    }
    std::map<std::string, nlohmann::json> tallies;
    for (const std::string& line : subscriber.OutLines()) {
      if (line[0] != '{') continue;
      const nlohmann::json tally = nlohmann::json::parse(line);
      tallies[tally["topic"].get<std::string>()] = tally;
    }
    return tallies;
  }

  static bool WaitUntil(const std::function<bool()>& condition,
                        std::chrono::milliseconds limit = std::chrono::seconds(15)) {
    const Clock::time_point end = Clock::now() + limit;
    while (!condition()) {
      if (Clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
  }

  // `frames` reports stamped now, at a steady pace.
  void Publish(int frames, FrameReport report, std::chrono::microseconds pace) {
    Clock::time_point next = Clock::now();
    for (int i = 0; i < frames; ++i) {
      report.sequence = ++sequence_;
      report.stamp = std::chrono::system_clock::now().time_since_epoch();
      const Clock::time_point before = Clock::now();
      publisher_->Publish(report);
      longest_publish_ = std::max(longest_publish_, Clock::now() - before);
      next += pace;
      std::this_thread::sleep_until(next);
    }
  }

  DdsDomain domain_;
  std::mt19937 random_{6};
  PublisherConfig config_;
  std::unique_ptr<Publisher> publisher_ = std::make_unique<Publisher>();
  std::filesystem::path folder_;
  int started_ = 0;
  std::uint64_t sequence_ = 0;
  Clock::duration longest_publish_{0};
};

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_PUBLISH_BUS_TEST_BASE_H_
