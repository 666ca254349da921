// The report: causes of false alarms, the page as a file, and the page as a browser shows it.
#include "tools/evaluation/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "box_model.h"
#include "eval_dataset.h"
#include "report_dataset.h"
#include "tools/evaluation/report/alarm_cause.h"
#include "tools/evaluation/report/html_page.h"

namespace wirepose::evaluation {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace testing;  // of the evaluation

// --- what a false alarm was ---

class AlarmCauseTest : public ::testing::Test {
 protected:
  AlarmCauseTest() : box_(0.3F, 0.2F, 0.15F) {
    ModelView other = box_.view();
    other.id = 2;
    models_.views = {box_.view(), other};
    PrepareModel(box_.view(), model_);
  }

  static Pose At(double x, double y, double z) { return {Matrix3d::Identity(), Vector3d(x, y, z)}; }
  static dataset::TrueInstance True(int object_id, const Pose& T) { return {object_id, T, 1}; }
  AlarmFacts Facts(const Pose& detected, const std::vector<dataset::TrueInstance>& truth) {
    return RelateToTruth(model_, detected, truth, models_);
  }

  wirepose::testing::BoxModel box_;
  ModelSet models_;
  PreparedModel model_;
};

TEST_F(AlarmCauseTest, WithoutTruthIsClutter) {
  const AlarmFacts facts = Facts(At(0, 0, 1), {});
  EXPECT_FALSE(facts.nearest || facts.covered || facts.other);
  EXPECT_EQ(CauseOf(facts, false), AlarmCause::kClutter);
}

TEST_F(AlarmCauseTest, NearAnInstanceIsAWrongPoseOrADuplicate) {
  const AlarmFacts facts = Facts(At(0.08, 0, 1), {True(1, At(1, 0, 1)), True(1, At(0, 0, 1))});
  EXPECT_EQ(facts.nearest, 1U);
  EXPECT_NEAR(facts.nearest_error_d, 0.08 / 0.3905, 1e-3);
  EXPECT_EQ(CauseOf(facts, false), AlarmCause::kWrongPose);
  EXPECT_EQ(CauseOf(facts, true), AlarmCause::kDuplicate);
}

TEST_F(AlarmCauseTest, BehindAnInstanceIsAWrongDistance) {
  const AlarmFacts facts = Facts(At(0.4, 0.2, 2.66), {True(1, At(0.3, 0.15, 2.0))});
  EXPECT_EQ(facts.covered, 0U);
  EXPECT_NEAR(facts.range_ratio, 1.33, 1e-3);
  EXPECT_EQ(CauseOf(facts, false), AlarmCause::kWrongDistance);
}

TEST_F(AlarmCauseTest, OnAnotherObjectSaysSo) {
  const AlarmFacts facts = Facts(At(0, 0, 1), {True(1, At(1, 0, 1)), True(2, At(0.1, 0, 1.05))});
  EXPECT_EQ(facts.other, 1U);
  EXPECT_EQ(CauseOf(facts, true), AlarmCause::kOtherObject);
}

TEST_F(AlarmCauseTest, InstancesWithoutModelArePassedOver) {
  EXPECT_EQ(CauseOf(Facts(At(0, 0, 1), {True(9, At(0, 0, 1))}), false), AlarmCause::kClutter);
}

// --- the page as a file ---

std::string Between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  if (begin == std::string::npos) return {};
  const std::size_t end = text.find(to, begin + from.size());
  return text.substr(begin + from.size(), end - begin - from.size());
}

Json DataOf(const std::string& page) { return Json::parse(Between(page, "id=\"data\">", "</script>")); }

TEST(ReportPage, KeepsTextText) {
  const std::string hostile = std::string("<!--") + kHostileName + "&\"{{script}}\xff";
  const std::string page = MakePage(hostile, {{"dataset", hostile}});
  EXPECT_THAT(page, Not(HasSubstr(kHostileName)));
  EXPECT_THAT(page, HasSubstr("<title>&lt;!--&lt;/script&gt;&lt;img src=x onerror=1&gt;&amp;&quot;"));
  const std::string kept = DataOf(page).at("dataset");
  EXPECT_THAT(kept, HasSubstr(kHostileName));
  EXPECT_THAT(kept, HasSubstr("{{script}}")) << "what is put in is not searched for marks";
}

TEST(ReportPage, NamesNothingOutsideOfItself) {
  const std::string page = MakePage("set", Json::object());
  for (std::size_t at = page.find("http"); at != std::string::npos; at = page.find("http", at + 1)) {
    EXPECT_EQ(page.substr(at, 26), "http://www.w3.org/2000/svg") << "an address";
  }
  EXPECT_THAT(page, Not(HasSubstr(" src=")));
  EXPECT_THAT(page, Not(HasSubstr("@import")));
  EXPECT_THAT(page, Not(HasSubstr("{{")));
}

// One evaluation for all tests below.
class ReportTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    ASSERT_NO_FATAL_FAILURE(WriteReportDataset(folder_->path()));
    const auto run = RunIn(
        folder_->path(),
        fmt::format("'{}' eval set --models models --out r.csv --json m.json --report page.html", WIREPOSE_PROGRAM));
    ASSERT_EQ(run.status, 0) << run.err;
    page_ = TextOf(folder_->path() / "page.html");
    data_ = DataOf(page_);
    measures_ = Json::parse(TextOf(folder_->path() / "m.json"));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static const Json& FrameOf(const Json& entry) {
    for (const Json& frame : data_.at("frames")) {
      if (frame.at("scene") == entry.at("scene_id") && frame.at("image") == entry.at("im_id")) return frame;
    }
    throw std::runtime_error("no such frame in the report");
  }

  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline std::string page_;
  static inline Json data_, measures_;
};

TEST_F(ReportTest, HoldsEveryMissWithItsCause) {
  int misses = 0, not_searched = 0;
  for (const Json& outcome : measures_.at("instances")) {
    if (outcome.at("hit")) continue;
    ++misses;
    const Json& instances = FrameOf(outcome).at("instances");
    const auto same = std::ranges::count_if(instances, [&](const Json& i) {
      return i.at("counts") && !i.at("hit") && i.at("object") == outcome.at("obj_id") &&
             i.at("mssd_mm") == outcome.at("mssd_mm") && i.at("cause") != "found";
    });
    EXPECT_EQ(same, 1) << outcome;
  }
  for (const Json& frame : data_.at("frames")) {
    for (const Json& i : frame.at("instances")) {
      not_searched += i.at("cause") == "not searched";
      EXPECT_EQ(i.contains("trace"), i.at("cause") != "not searched");
    }
  }
  EXPECT_EQ(not_searched, 1) << "the refrigerator has no model";
  EXPECT_GE(misses, 2);
}

TEST_F(ReportTest, HoldsEveryFalseAlarmWithItsCause) {
  ASSERT_FALSE(measures_.at("false_positives").empty());
  int wrong_pose = 0;
  for (const Json& alarm : measures_.at("false_positives")) {
    const Json& detections = FrameOf(alarm).at("detections");
    const auto same = std::ranges::find_if(detections, [&](const Json& d) {
      return d.at("verdict") == "false" && d.at("object") == alarm.at("obj_id") &&
             std::abs(d.at("score").get<double>() - alarm.at("score").get<double>()) < 1e-6;
    });
    ASSERT_NE(same, detections.end()) << alarm;
    EXPECT_TRUE(same->at("evidence").contains("edges"));
    wrong_pose += same->at("cause") == "wrong pose";
  }
  EXPECT_GE(wrong_pose, 1) << "a detection lies 80 mm beside a true instance";
}

TEST_F(ReportTest, HoldsPicturesLinesAndCurves) {
  ASSERT_EQ(data_.at("frames").size(), 3U);
  for (const Json& frame : data_.at("frames")) {
    for (const char* eye : {"left", "right"}) {
      EXPECT_THAT(frame.at("pictures").at(eye).get<std::string>(),
                  ::testing::StartsWith("data:image/jpeg;base64,/9j/"));
    }
    EXPECT_GT(frame.at("segments").size(), 4U * 50);
    EXPECT_GT(frame.at("lines").size(), 6U * 20);
    EXPECT_EQ(frame.at("lines").size() % 6, 0U);
  }
  EXPECT_FALSE(data_.at("measures").at("score_curve").empty());
  EXPECT_TRUE(data_.at("measures").at("calibration").at("expected_error").is_number());
  EXPECT_LT(page_.size(), 3U * 600'000) << "16 frames must stay below 10 MB";
}

// Lowering the threshold only adds: what was reported stays as it was.
TEST_F(ReportTest, ContinuesTheCurveBelowWhatWasReported) {
  const Json& curve = data_.at("measures").at("score_curve");
  const Json& continued = data_.at("measures").at("continued_curve");
  ASSERT_GT(continued.size(), curve.size()) << "the frames have candidates that were not reported";
  for (const Json& point : curve) EXPECT_THAT(continued, ::testing::Contains(point));
  EXPECT_GE(continued.back().at("recall"), curve.back().at("recall"));
}

TEST_F(ReportTest, RefusesAFileThatCannotBeWritten) {
  const auto run =
      RunIn(folder_->path(), fmt::format("'{}' eval set --out r2.csv --report no/where.html", WIREPOSE_PROGRAM));
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("no/where.html"));
}

TEST_F(ReportTest, ScriptJudgesASuite) {
  fs::create_directory(folder_->path() / "suite");
  fs::create_directory_symlink(folder_->path() / "set", folder_->path() / "suite/recorded");
  const auto run = RunIn(
      folder_->path(), fmt::format("python3 '{}' --bin '{}' --suite suite --data nowhere --out ev --no-peer --no-docs",
                                   WIREPOSE_EVALUATE, fs::path(WIREPOSE_PROGRAM).parent_path().string()));
  ASSERT_EQ(run.status, 0) << run.out << run.err;
  // The refrigerator stands beyond the range that the suite's targets speak of.
  const Json& total = measures_.at("total");
  EXPECT_THAT(run.out, ::testing::ContainsRegex(fmt::format("simulated suite +recall .*\\({} of {}\\)",
                                                            total.at("true_positives").get<int>(),
                                                            total.at("instances").get<int>() - 1)));
  EXPECT_THAT(run.out, ::testing::ContainsRegex("kitchen-sample +recall .*no data here"));
  EXPECT_TRUE(fs::exists(folder_->path() / "ev/suite-recorded.html"));
}

TEST_F(ReportTest, WorksInABrowser) {
  constexpr int kNoBrowser = 77;
  const auto run = RunIn(folder_->path(), fmt::format("python3 '{}' page.html", WIREPOSE_PAGE_TEST));
  if (run.status == kNoBrowser) GTEST_SKIP() << run.out;
  EXPECT_EQ(run.status, 0) << run.out << run.err;
}

}  // namespace
}  // namespace wirepose::evaluation
