// What `wirepose eval` writes for fitting: corresponding pairs, every promoted line set, every verified candidate, and
// whether they are right.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "eval_dataset.h"
#include "report_dataset.h"
#include "stages/evidence.h"
#include "stages/pair_rank.h"
#include "stages/set_rank.h"
#include "tools/evaluation/results_csv.h"

namespace wirepose::evaluation {
namespace {

namespace fs = std::filesystem;
using testing::RunIn;

using Row = std::map<std::string, std::string>;

// The rows of a CSV file by the names of its first line. Fails where a line has another number of fields.
std::vector<Row> ReadRows(const fs::path& file, std::vector<std::string>& names) {
  const auto fields = [](const std::string& line) {
    std::vector<std::string> out;
    std::istringstream in(line);
    for (std::string field; std::getline(in, field, ',');) out.push_back(field);
    return out;
  };
  std::vector<Row> rows;
  std::ifstream in(file);
  std::string line;
  if (std::getline(in, line)) names = fields(line);
  while (std::getline(in, line)) {
    const std::vector<std::string> values = fields(line);
    EXPECT_EQ(values.size(), names.size()) << line;
    for (std::size_t i = 0; i < std::min(values.size(), names.size()); ++i) {
      if (i == 0) rows.emplace_back();
      rows.back()[names[i]] = values[i];
    }
  }
  return rows;
}

class FitLogs : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const testing::TemporaryFolder folder;
    ASSERT_NO_FATAL_FAILURE(testing::WriteReportDataset(folder.path()));
    const auto run =
        RunIn(folder.path(),
              fmt::format("'{}' eval set --models models --out r.csv --candidates c.csv --sets s.csv --pairs p.csv",
                          WIREPOSE_PROGRAM));
    ASSERT_EQ(run.status, 0) << run.err;
    sets_ = ReadRows(folder.path() / "s.csv", set_names_);
    pairs_ = ReadRows(folder.path() / "p.csv", pair_names_);
    candidates_ = ReadRows(folder.path() / "c.csv", candidate_names_);
    const auto detections = ReadResults(folder.path() / "r.csv");
    ASSERT_TRUE(detections) << detections.error();
    detections_ = *detections;
  }

  // The smallest error among the rows of a detection's frame and object; above 9 when there is none.
  static double LeastError(const std::vector<Row>& rows, const Estimate& detection) {
    double least = 10;
    for (const Row& row : rows) {
      if (std::stoi(row.at("im_id")) == detection.image_id && std::stoi(row.at("obj_id")) == detection.object_id)
        least = std::min(least, std::stod(row.at("error_d")));
    }
    return least;
  }

  static inline std::vector<Row> pairs_, sets_, candidates_;
  static inline std::vector<std::string> pair_names_, set_names_, candidate_names_;
  static inline std::vector<Estimate> detections_;
};

TEST_F(FitLogs, NameEveryTerm) {
  const auto ends_with = [](const std::vector<std::string>& names, const auto& terms) {
    return names.size() > terms.size() && std::equal(terms.begin(), terms.end(), names.end() - std::ssize(terms));
  };
  EXPECT_TRUE(ends_with(set_names_, SetTermNames()));
  EXPECT_TRUE(ends_with(pair_names_, PairTermNames()));
  for (const char* term : EvidenceTermNames())
    EXPECT_EQ(std::count(candidate_names_.begin(), candidate_names_.end(), term), 1) << term;
}

TEST_F(FitLogs, HoldFewerCandidatesThanSets) {
  EXPECT_GT(candidates_.size(), 0U);
  EXPECT_GT(sets_.size(), candidates_.size());
}

// The data set's truth is made of what was detected: a candidate lies on it, and a set nearby led there. Where an
// object has no true instance in a frame nothing is right.
TEST_F(FitLogs, TellTheTruthFromTheRest) {
  ASSERT_FALSE(detections_.empty());
  int right = 0;
  for (const Estimate& detection : detections_) {
    const double error = LeastError(candidates_, detection);
    if (error > 0.001) continue;
    ++right;
    EXPECT_LT(LeastError(sets_, detection), 0.1)
        << "frame " << detection.image_id << ", object " << detection.object_id;
  }
  EXPECT_GE(right, 1);
  int alone = 0;
  for (const Row& row : sets_) alone += row.at("error_d") == "9.0000" ? 1 : 0;
  EXPECT_GT(alone, 0);
  EXPECT_LT(alone, static_cast<int>(sets_.size()));
}

// Objects that were detected have right pairs, of lines that cover their edges; a wrong pair stands for many.
TEST_F(FitLogs, PairsAreRightWhereAnObjectIs) {
  int right = 0, wrong = 0;
  for (const Row& row : pairs_) {
    const bool is_right = row.at("instance") != "-1";
    (is_right ? right : wrong) += 1;
    EXPECT_EQ(row.at("weight"), is_right ? "1" : "200");
    const auto found = std::find_if(detections_.begin(), detections_.end(), [&](const Estimate& d) {
      return d.image_id == std::stoi(row.at("im_id")) && d.object_id == std::stoi(row.at("obj_id"));
    });
    if (!is_right) continue;
    EXPECT_NE(found, detections_.end()) << "frame " << row.at("im_id") << ", object " << row.at("obj_id");
  }
  EXPECT_GE(right, 3);
  EXPECT_GT(wrong, 3);
}

TEST_F(FitLogs, AFileThatCannotBeWrittenIsNamed) {
  const testing::TemporaryFolder folder;
  ASSERT_NO_FATAL_FAILURE(testing::WriteReportDataset(folder.path()));
  for (const char* option : {"--pairs", "--sets", "--candidates"}) {
    const auto run = RunIn(folder.path(), fmt::format("'{}' eval set --models models --out r.csv {} none/such/x.csv",
                                                      WIREPOSE_PROGRAM, option));
    EXPECT_EQ(run.status, 2) << option;
    EXPECT_NE(run.err.find("none/such/x.csv"), std::string::npos) << run.err;
  }
}

}  // namespace
}  // namespace wirepose::evaluation
