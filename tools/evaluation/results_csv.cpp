#include "tools/evaluation/results_csv.h"

#include <charconv>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

namespace wirepose::evaluation {
namespace {

constexpr const char* kHeader = "scene_id,im_id,obj_id,score,R,t,time";

std::string Blanked(std::span<const double> numbers) { return fmt::format("{}", fmt::join(numbers, " ")); }

std::string Row(const Estimate& e) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R = e.T_camera_model.R;
  return fmt::format("{},{},{},{},{},{},{}\n", e.scene_id, e.image_id, e.object_id, e.score,
                     Blanked(std::span(R.data(), 9)), Blanked(std::span(e.T_camera_model.t_mm.data(), 3)), e.time_s);
}

template <typename Number>
bool Parse(const std::string& text, Number& out) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return false;
  const auto end = text.find_last_not_of(" \t\r") + 1;
  const auto [rest, error] = std::from_chars(text.data() + begin, text.data() + end, out);
  return error == std::errc{} && rest == text.data() + end;
}

bool ParseAll(const std::string& text, std::span<double> out) {
  std::istringstream words(text);
  std::string word;
  std::size_t n = 0;
  while (words >> word) {
    if (n == out.size() || !Parse(word, out[n])) return false;
    ++n;
  }
  return n == out.size();
}

std::vector<std::string> Split(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
  if (!line.empty() && line.back() == ',') fields.emplace_back();
  return fields;
}

// Empty on success, else what is wrong.
std::string ParseRow(const std::vector<std::string>& f, Estimate& e) {
  if (f.size() != 6 && f.size() != 7) return fmt::format("7 fields are expected, not {}", f.size());
  const bool ids = Parse(f[0], e.scene_id) && Parse(f[1], e.image_id) && Parse(f[2], e.object_id);
  if (!ids || !Parse(f[3], e.score)) return "scene_id, im_id, obj_id and score must be numbers";
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R;
  if (!ParseAll(f[4], std::span(R.data(), 9)) || !ParseAll(f[5], std::span(e.T_camera_model.t_mm.data(), 3))) {
    return "R needs 9 and t 3 numbers separated by blanks";
  }
  e.T_camera_model.R = R;
  const bool has_time = f.size() == 7 && f[6].find_first_not_of(" \t\r") != std::string::npos;
  if (has_time && !Parse(f[6], e.time_s)) return "time must be a number of seconds";
  return {};
}

}  // namespace

Result<void, std::string> WriteResults(const std::filesystem::path& file, std::span<const Estimate> estimates) {
  std::ofstream out(file);
  out << kHeader << '\n';
  for (const Estimate& e : estimates) out << Row(e);
  out.close();
  if (out) return {};
  return unexpected<std::string>(file.string() + ": cannot be written; check the folder and the free space");
}

Result<std::vector<Estimate>, std::string> ReadResults(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) return unexpected<std::string>(file.string() + ": cannot be opened; give a BOP results file");
  std::vector<Estimate> estimates;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#' || line.compare(first, 8, "scene_id") == 0) continue;
    Estimate estimate;
    const std::string wrong = ParseRow(Split(line), estimate);
    if (!wrong.empty()) {
      return unexpected<std::string>(
          fmt::format("{}:{}: {}; the columns are {}", file.string(), number, wrong, kHeader));
    }
    estimates.push_back(estimate);
  }
  return estimates;
}

}  // namespace wirepose::evaluation
