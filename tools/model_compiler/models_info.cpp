#include "tools/model_compiler/models_info.h"

#include <fstream>
#include <nlohmann/json.hpp>

namespace wirepose::tools {
namespace {

constexpr double kMmPerM = 1000;

double Millimetres(float metres) { return kMmPerM * static_cast<double>(metres); }

nlohmann::ordered_json SymmetryMatrix(const ModelSymmetry& s) {
  auto matrix = nlohmann::ordered_json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix.push_back(static_cast<double>(s.rotation[3 * row + column]));
    matrix.push_back(Millimetres(s.translation_m[row]));
  }
  for (const double v : {0.0, 0.0, 0.0, 1.0}) matrix.push_back(v);
  return matrix;
}

nlohmann::ordered_json Info(const ModelView& m) {
  nlohmann::ordered_json info;
  info["diameter"] = Millimetres(m.diameter_m);
  const char* const axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) info[std::string("min_") + axes[i]] = Millimetres(m.box_min_m[i]);
  for (int i = 0; i < 3; ++i) info[std::string("size_") + axes[i]] = Millimetres(m.box_max_m[i] - m.box_min_m[i]);
  if (!m.symmetries.empty()) {
    auto list = nlohmann::ordered_json::array();
    for (const ModelSymmetry& s : m.symmetries) list.push_back(SymmetryMatrix(s));
    info["symmetries_discrete"] = list;
  }
  return info;
}

}  // namespace

Result<void, std::string> WriteModelsInfo(const std::filesystem::path& file, std::span<const ModelView> models) {
  nlohmann::ordered_json all = nlohmann::ordered_json::object();
  for (const ModelView& m : models) all[std::to_string(m.id)] = Info(m);
  std::ofstream out(file);
  out << all.dump(2) << '\n';
  out.close();
  if (!out) return unexpected(file.string() + ": cannot be written; check that the folder exists and is writable");
  return {};
}

}  // namespace wirepose::tools
