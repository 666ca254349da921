#include "tools/evaluation/model_set.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>

namespace wirepose::evaluation {
namespace {

namespace fs = std::filesystem;

// Files of `folder` with the extension, by name.
std::vector<fs::path> FilesIn(const fs::path& folder, const std::string& extension) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() == extension) files.push_back(it->path());
  }
  std::ranges::sort(files);
  return files;
}

// N of obj_00000N.ply.
std::optional<int> IdInName(const fs::path& mesh) {
  const std::string stem = mesh.stem().string();
  if (!stem.starts_with("obj_")) return std::nullopt;
  int id = 0;
  const char* end = stem.data() + stem.size();
  const auto [rest, error] = std::from_chars(stem.data() + 4, end, id);
  if (error != std::errc{} || rest != end) return std::nullopt;
  return id;
}

bool IsWanted(int id, const std::vector<int>& wanted) {
  return wanted.empty() || std::ranges::find(wanted, id) != wanted.end();
}

Result<std::vector<tools::CompiledModel>, std::string> CompileMeshes(const fs::path& folder,
                                                                     const std::vector<int>& wanted) {
  std::vector<tools::CompiledModel> out;
  for (const fs::path& mesh : FilesIn(folder, ".ply")) {
    const std::optional<int> id = IdInName(mesh);
    if (!id || !IsWanted(*id, wanted)) continue;
    tools::CompileOptions options;
    options.id = static_cast<std::uint32_t>(*id);
    auto model = tools::CompileModel(mesh, options);
    if (!model) return unexpected<std::string>(model.error());
    out.push_back(std::move(*model));
  }
  return out;
}

Result<std::vector<tools::CompiledModel>, std::string> ReadFiles(const fs::path& models,
                                                                 const std::vector<int>& wanted) {
  std::vector<tools::CompiledModel> out;
  const auto files = fs::is_directory(models) ? FilesIn(models, ".wpm") : std::vector<fs::path>{models};
  for (const fs::path& file : files) {
    auto model = tools::ReadModelFile(file);
    if (!model) return unexpected<std::string>(model.error());
    if (IsWanted(static_cast<int>(model->View().id), wanted)) out.push_back(std::move(*model));
  }
  return out;
}

}  // namespace

const ModelView* ModelSet::Find(std::uint32_t id) const {
  const auto it = std::ranges::find(views, id, &ModelView::id);
  return it != views.end() ? &*it : nullptr;
}

Result<ModelSet, std::string> LoadModelSet(const fs::path& dataset, const fs::path& models,
                                           const std::vector<int>& object_ids) {
  const fs::path source = models.empty() ? dataset / "models" : models;
  auto files = models.empty() ? CompileMeshes(source, object_ids) : ReadFiles(source, object_ids);
  if (!files) return unexpected<std::string>(files.error());
  ModelSet set;
  set.files = std::move(*files);
  for (const tools::CompiledModel& file : set.files) set.views.push_back(file.View());
  std::ranges::sort(set.views, {}, &ModelView::id);
  for (int id : object_ids) {
    if (set.Find(static_cast<std::uint32_t>(id)) != nullptr) continue;
    return unexpected<std::string>(fmt::format(
        "{}: unknown model id {}: no model there has it; choose one that is there or build it", source.string(), id));
  }
  if (!set.views.empty()) return set;
  return unexpected<std::string>(
      fmt::format("{}: no models; {}", source.string(),
                  models.empty() ? "obj_00000N.ply files are expected" : "build some with 'wirepose model build'"));
}

}  // namespace wirepose::evaluation
