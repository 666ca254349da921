#include "model_command.h"

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "tools/model_compiler/model_compiler.h"
#include "tools/model_compiler/wireframe_drawing.h"

namespace wirepose::cli {
namespace {

namespace fs = std::filesystem;

struct BuildArguments {
  std::vector<std::string> meshes;
  std::string unit = "mm";
  std::uint32_t id = 0;  // 0: from the file name, else counted from 1
  std::string name;
  std::string out;
};

struct ShowArguments {
  std::string file;
  std::string png;
};

// The number of a BOP file name, obj_000012.ply: 12; of any other name 0.
std::uint32_t IdOfFileName(const fs::path& mesh) {
  unsigned id = 0;
  int used = 0;
  const std::string stem = mesh.stem().string();
  const bool matches = std::sscanf(stem.c_str(), "obj_%6u%n", &id, &used) == 1;
  return matches && used == static_cast<int>(stem.size()) ? id : 0;
}

void BuildOne(const fs::path& mesh, const fs::path& out, const tools::CompileOptions& options) {
  const auto model = tools::CompileModel(mesh, options);
  if (!model) throw WorkFailed(model.error());
  for (const std::string& note : model->notes) std::fprintf(stderr, "%s: %s\n", mesh.c_str(), note.c_str());
  if (const auto written = tools::WriteModelFile(out, *model); !written) throw WorkFailed(written.error());
  const ModelView view = model->View();
  std::printf("%s: id %u, '%.*s', %.1f mm, %zu edges, %zu faces, %zu symmetries, %zu bytes\n", out.c_str(), view.id,
              static_cast<int>(view.name.size()), view.name.data(), 1e3 * static_cast<double>(view.diameter_m),
              view.edges.size(), view.faces.size(), view.symmetries.size(), model->bytes.size());
}

void Build(const BuildArguments& arguments) {
  const bool many = arguments.meshes.size() > 1;
  const fs::path out = arguments.out;
  if (many && !arguments.name.empty()) throw UsageError("--name: names one model; leave it out for several meshes");
  if (many && (out.extension() == ".wpm" || fs::is_regular_file(out))) {
    throw UsageError(out.string() + ": --out must be a folder for several meshes");
  }
  std::error_code error;
  if (many) fs::create_directories(out, error);
  if (error) throw WorkFailed(out.string() + ": cannot be created (" + error.message() + "); choose another --out");

  std::map<std::uint32_t, std::string> used_ids;
  std::uint32_t next_id = arguments.id == 0 ? 1 : arguments.id;
  for (const fs::path mesh : arguments.meshes) {
    tools::CompileOptions options;
    options.unit = arguments.unit == "m" ? tools::MeshUnit::kMetre : tools::MeshUnit::kMillimetre;
    options.name = arguments.name;
    const std::uint32_t named_id = arguments.id == 0 ? IdOfFileName(mesh) : 0;
    options.id = named_id != 0 ? named_id : next_id;
    next_id = options.id + 1;
    const auto [other, is_new] = used_ids.try_emplace(options.id, mesh.string());
    if (!is_new) {
      throw UsageError(mesh.string() + ": gets the id " + std::to_string(options.id) + " of " + other->second +
                       "; build them one by one with --id");
    }
    const bool into_folder = many || fs::is_directory(out);
    BuildOne(mesh, into_folder ? out / mesh.filename().replace_extension(".wpm") : out, options);
  }
}

void PrintEdges(const ModelView& m) {
  constexpr std::size_t kShown = 12;
  std::printf("longest edges (mm, degrees between the faces):\n");
  for (std::size_t i = 0; i < m.edges.size() && i < kShown; ++i) {
    const ModelEdge& e = m.edges[i];
    const char* shape = e.face[1] == kNoFace ? "border" : e.convex != 0 ? "ridge" : "valley";
    std::printf("  %3zu  %8.1f  %5.1f  %s\n", i, 1e3 * static_cast<double>(e.length_m),
                static_cast<double>(e.dihedral_rad) * 180 / M_PI, shape);
  }
}

void PrintSymmetries(const ModelView& m) {
  std::printf("symmetries beside the identity: %zu\n", m.symmetries.size());
  for (const ModelSymmetry& s : m.symmetries) {
    Matrix3 R;
    for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = s.rotation[i];
    const Eigen::AngleAxisf turn(R);
    std::printf("  %5.1f degrees about (%+.3f %+.3f %+.3f)\n", static_cast<double>(turn.angle()) * 180 / M_PI,
                static_cast<double>(turn.axis().x()), static_cast<double>(turn.axis().y()),
                static_cast<double>(turn.axis().z()));
  }
}

void Print(const ModelView& m, std::size_t bytes) {
  const Vector3 size = 1e3F * (m.box_max_m - m.box_min_m);
  std::size_t parallel_sets = 0, parallel_members = 0;
  for (const ModelLineSet& s : m.line_sets) {
    if (s.kind != LineSetKind::kParallel) continue;
    ++parallel_sets;
    parallel_members += s.member_count;
  }
  std::printf("name        %.*s\nid          %u\nchecksum    %08x\n", static_cast<int>(m.name.size()), m.name.data(),
              m.id, m.checksum);
  std::printf("size        %.1f x %.1f x %.1f mm, diameter %.1f mm\n", static_cast<double>(size.x()),
              static_cast<double>(size.y()), static_cast<double>(size.z()), 1e3 * static_cast<double>(m.diameter_m));
  std::printf("geometry    %zu vertices, %zu triangles, %zu faces, %zu edges, %zu bytes\n", m.vertices.size(),
              m.triangles.size(), m.faces.size(), m.edges.size(), bytes);
  std::printf("line sets   %zu parallel with %zu members, %zu intersecting with %zu members\n", parallel_sets,
              parallel_members, m.line_sets.size() - parallel_sets, m.set_members.size() - parallel_members);
  std::printf("aspects     %zu\n", m.aspects.size());
  PrintEdges(m);
  PrintSymmetries(m);
}

void Show(const ShowArguments& arguments) {
  const auto model = tools::ReadModelFile(arguments.file);
  if (!model) throw WorkFailed(model.error());
  Print(model->View(), model->bytes.size());
  if (arguments.png.empty()) return;
  if (const auto drawn = tools::DrawWireframe(model->View(), arguments.png); !drawn) throw WorkFailed(drawn.error());
  std::printf("drawing     %s\n", arguments.png.c_str());
}

}  // namespace

void AddModelCommand(CLI::App& app) {
  CLI::App* model = app.add_subcommand("model", "make line models from meshes and look at them");
  model->require_subcommand(1);

  auto build_arguments = std::make_shared<BuildArguments>();
  CLI::App* build = model->add_subcommand("build", "turn meshes (PLY, OBJ, STL ...) into line models (.wpm)");
  build->add_option("MESH", build_arguments->meshes, "mesh files")->required();
  build->add_option("--unit", build_arguments->unit, "unit of the mesh files")
      ->check(CLI::IsMember({"mm", "m"}))
      ->capture_default_str();
  build->add_option("--id", build_arguments->id, "object id of the first mesh; default: N of obj_N names, else 1 on")
      ->check(CLI::PositiveNumber);
  build->add_option("--name", build_arguments->name, "name of the model; default: that of the mesh file");
  build->add_option("--out", build_arguments->out, "model file to write, or a folder")->required();
  build->callback([build_arguments] { Build(*build_arguments); });

  auto show_arguments = std::make_shared<ShowArguments>();
  CLI::App* show = model->add_subcommand("show", "print what a model file holds and draw it");
  show->add_option("FILE", show_arguments->file, "model file (.wpm)")->required();
  show->add_option("--png", show_arguments->png, "draw the wireframe into this picture");
  show->callback([show_arguments] { Show(*show_arguments); });
}

}  // namespace wirepose::cli
