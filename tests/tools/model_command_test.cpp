// `wirepose model`, run as users run it: exit status, one line on stderr, files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

#include "tools/model_compiler/model_compiler.h"

namespace wirepose {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

struct Outcome {
  int status = -1;
  std::string output;  // stdout and stderr
};

Outcome RunWirepose(const std::string& arguments) {
  const std::string command = std::string("\"") + WIREPOSE_PROGRAM + "\" " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  Outcome outcome;
  if (pipe == nullptr) return outcome;
  std::array<char, 512> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) outcome.output += buffer.data();
  const int status = pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

class ModelCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("wirepose_command_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string Mesh(const char* name) { return std::string(WIREPOSE_MODELS) + "/" + name + ".ply"; }
  [[nodiscard]] std::string Out(const char* name) const { return (folder_ / name).string(); }
  fs::path folder_;
};

TEST_F(ModelCommand, BuildsAndShows) {
  const Outcome built = RunWirepose("model build " + Mesh("book") + " --id 5 --name atlas --out " + Out("a.wpm"));
  EXPECT_EQ(built.status, 0) << built.output;
  const auto model = tools::ReadModelFile(Out("a.wpm"));
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->View().id, 5U);
  EXPECT_EQ(model->View().name, "atlas");
  EXPECT_FLOAT_EQ(model->View().edges[0].length_m, 0.24F);

  const Outcome shown = RunWirepose("model show " + Out("a.wpm") + " --png " + Out("a.png"));
  EXPECT_EQ(shown.status, 0) << shown.output;
  EXPECT_THAT(shown.output, HasSubstr("240.0 x 165.0 x 35.0 mm"));
  EXPECT_THAT(shown.output, HasSubstr("12 edges"));
  EXPECT_GT(fs::file_size(Out("a.png")), 1000U);
}

TEST_F(ModelCommand, SeveralMeshesGoIntoAFolderWithCountedIds) {
  const Outcome built =
      RunWirepose("model build " + Mesh("parcel_box") + " " + Mesh("book") + " --out " + Out("models"));
  EXPECT_EQ(built.status, 0) << built.output;
  EXPECT_EQ(tools::ReadModelFile(folder_ / "models" / "parcel_box.wpm").value().View().id, 1U);
  EXPECT_EQ(tools::ReadModelFile(folder_ / "models" / "book.wpm").value().View().id, 2U);
}

TEST_F(ModelCommand, BopNamesCarryTheId) {
  fs::copy_file(Mesh("book"), folder_ / "obj_000042.ply");
  EXPECT_EQ(RunWirepose("model build " + Out("obj_000042.ply") + " --out " + Out("b.wpm")).status, 0);
  EXPECT_EQ(tools::ReadModelFile(Out("b.wpm")).value().View().id, 42U);
}

TEST_F(ModelCommand, FailuresHaveStatusOneAndOneLine) {
  for (const std::string& arguments :
       {"model build " + Out("absent.ply") + " --out " + Out("a.wpm"), "model show " + Out("absent.wpm"),
        "model show " + Mesh("book"), "model build " + Mesh("book") + " --out " + Out("no/such/folder/a.wpm")}) {
    const Outcome outcome = RunWirepose(arguments);
    EXPECT_EQ(outcome.status, 1) << arguments << outcome.output;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("wirepose: "));
  }
}

TEST_F(ModelCommand, MisuseHasStatusTwo) {
  const std::string two = "model build " + Mesh("book") + " " + Mesh("parcel_box");
  for (const std::string& arguments :
       {std::string("model"), "model build " + Mesh("book"), "model build " + Mesh("book") + " --unit inch --out x.wpm",
        "model build " + Mesh("book") + " --id -1 --out x.wpm", two + " --out " + Out("one.wpm"),
        two + " --name both --out " + Out("models")}) {
    EXPECT_EQ(RunWirepose(arguments).status, 2) << arguments;
  }
}

}  // namespace
}  // namespace wirepose
