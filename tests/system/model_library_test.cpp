// As many model files as the recognizer can hold, and one more.
#include "app/model_library.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <fstream>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "model/crc32c.h"
#include "model/model_format.h"

namespace wirepose::app {
namespace {

// A folder with copies of one model file under other ids.
class ModelLibraryTest : public ::testing::Test {
 protected:
  ModelLibraryTest() {
    std::filesystem::create_directory(folder_);
    const std::filesystem::path file = WIREPOSE_GOLDEN "/parcel_box.wpm";
    bytes_.resize(std::filesystem::file_size(file));
    std::ifstream(file, std::ios::binary).read(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  }
  ~ModelLibraryTest() override { std::filesystem::remove_all(folder_); }

  // By name in the order of the ids.
  [[nodiscard]] std::filesystem::path FileOf(std::uint32_t id) const { return folder_ / (std::to_string(id) + ".wpm"); }
  void Write(std::uint32_t id) {
    std::memcpy(bytes_.data() + offsetof(ModelFileHeader, id), &id, sizeof id);
    constexpr std::size_t kCrc = offsetof(ModelFileHeader, crc32c);
    const std::uint32_t crc = Crc32c(std::as_bytes(std::span(bytes_)).subspan(kCrc + sizeof(std::uint32_t)));
    std::memcpy(bytes_.data() + kCrc, &crc, sizeof crc);
    std::ofstream(FileOf(id), std::ios::binary).write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  }
  void ExpectSearched(const std::vector<std::uint32_t>& ids) const {
    const ModelIds searched = library_.searched_ids();
    EXPECT_EQ(std::vector<std::uint32_t>(searched.begin(), searched.end()), ids);
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("wirepose_models_" + std::to_string(getpid()));
  std::vector<char> bytes_;
  static inline Recognizer recognizer_;
  static inline ModelLibrary library_{recognizer_};
};

constexpr std::uint32_t kFirst = 100;
constexpr std::uint32_t kLast = kFirst + kMaxModels - 1;

TEST_F(ModelLibraryTest, HoldsAsManyAsTheRecognizerAndRefusesOneMore) {
  for (std::uint32_t id = kFirst; id <= kLast; ++id) Write(id);
  library_.Load({folder_});
  std::vector<std::uint32_t> all(kMaxModels);
  std::iota(all.begin(), all.end(), kFirst);
  ExpectSearched(all);
  EXPECT_EQ(library_.Select({}), "");
  ExpectSearched(all);
  ModelIds every;
  for (const std::uint32_t id : all) every.push_back(id);
  EXPECT_EQ(library_.Select(every), "");
  ExpectSearched(all);
  ModelIds last;
  last.push_back(kLast);
  EXPECT_EQ(library_.Select(last), "");
  EXPECT_EQ(library_.searched(), std::uint32_t{1} << (kMaxModels - 1));
  EXPECT_EQ(library_.Reload(), "");
  ExpectSearched({kLast});

  Write(kLast + 1);
  const std::string refusal = library_.Reload();
  EXPECT_NE(refusal.find("one model too many; at most " + std::to_string(kMaxModels)), std::string::npos) << refusal;
  ExpectSearched({kLast});
  EXPECT_EQ(recognizer_.models().size(), kMaxModels);
  EXPECT_EQ(recognizer_.models().back().id, kLast);
  std::filesystem::remove(FileOf(kLast + 1));
  EXPECT_EQ(library_.Select({}), "");
  EXPECT_EQ(library_.Reload(), "");
  ExpectSearched(all);
}

}  // namespace
}  // namespace wirepose::app
