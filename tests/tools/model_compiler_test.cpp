#include "tools/model_compiler/model_compiler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/mesh/test_meshes.h"
#include "tests/model/model_consistency.h"
#include "tests/tools/model_test_options.h"
#include "tools/model_compiler/models_info.h"

namespace wirepose {
namespace {

using mesh::Mesh;
using testing::BoxMesh;
using ::testing::HasSubstr;
using testing::TestOptions;
using tools::CompiledModel;
using tools::CompileModel;

CompiledModel Compile(const Mesh& mesh) {
  auto model = CompileModel(mesh, TestOptions());
  EXPECT_TRUE(model.has_value()) << (model ? "" : model.error());
  if (!model) return CompileModel(BoxMesh(1, 1, 1), TestOptions()).value();
  EXPECT_EQ(testing::FindInconsistency(model->View()), nullptr);
  return *std::move(model);
}

std::string ErrorOf(const Mesh& mesh) {
  const auto model = CompileModel(mesh, TestOptions());
  return model ? "" : model.error();
}

TEST(ModelCompiler, BoxIsWhatEverybodyExpects) {
  const CompiledModel model = Compile(BoxMesh(0.3, 0.2, 0.15));
  const ModelView m = model.View();
  EXPECT_TRUE(model.notes.empty());
  EXPECT_EQ(m.vertices.size(), 8U);
  EXPECT_EQ(m.triangles.size(), 12U);
  EXPECT_EQ(m.faces.size(), 6U);
  ASSERT_EQ(m.edges.size(), 12U);
  EXPECT_EQ(m.symmetries.size(), 3U);
  EXPECT_EQ(m.aspects.size(), 162U);
  EXPECT_EQ(m.line_sets.size(), 24U);
  EXPECT_FLOAT_EQ(m.diameter_m, std::sqrt(0.3F * 0.3F + 0.2F * 0.2F + 0.15F * 0.15F));
  for (std::size_t e = 0; e < 12; ++e) {
    EXPECT_FLOAT_EQ(m.edges[e].length_m, e < 4 ? 0.3F : e < 8 ? 0.2F : 0.15F);
    EXPECT_NEAR(m.edges[e].dihedral_rad, M_PI / 2, 1e-5);
    EXPECT_EQ(m.edges[e].convex, 1U);
  }
  float area = 0;
  for (const ModelFace& f : m.faces) {
    area += f.area_m2;
    EXPECT_GT(f.offset_m, 0);  // the origin is inside, so outward normals have positive offsets
  }
  EXPECT_FLOAT_EQ(area, 2 * (0.3F * 0.2F + 0.2F * 0.15F + 0.3F * 0.15F));
}

TEST(ModelCompiler, EdgesNameTheTwoFacesTheyLieIn) {
  const CompiledModel model = Compile(testing::TwoPartMesh());
  const ModelView m = model.View();
  for (const ModelEdge& e : m.edges) {
    for (const std::uint16_t f : e.face) {
      for (const std::uint16_t v : e.vertex) {
        EXPECT_NEAR(Vector3(m.faces[f].normal).dot(m.VertexPosition(v)), m.faces[f].offset_m, 1e-6);
      }
    }
  }
}

TEST(ModelCompiler, OrderOfVerticesAndTrianglesDoesNotMatter) {
  std::mt19937 random(3);
  for (const Mesh& mesh : {BoxMesh(0.3, 0.2, 0.15), testing::TwoPartMesh(), testing::PrismMesh(7, 0.1, 0.3)}) {
    const CompiledModel reference = Compile(mesh);
    for (int i = 0; i < 5; ++i) {
      EXPECT_EQ(Compile(testing::Shuffled(mesh, random)).bytes, reference.bytes);
      EXPECT_EQ(Compile(testing::Shuffled(testing::Soup(mesh), random)).bytes, reference.bytes);
    }
  }
}

TEST(ModelCompiler, RepairsWindingDuplicatesAndSlivers) {
  const CompiledModel reference = Compile(BoxMesh(0.3, 0.2, 0.15));
  std::mt19937 random(4);
  for (int i = 0; i < 20; ++i) {
    Mesh mesh = BoxMesh(0.3, 0.2, 0.15);
    for (auto& t : mesh.triangles) {
      if (random() % 2 == 0) std::swap(t[0], t[1]);  // inside out
    }
    mesh.triangles.push_back(mesh.triangles[random() % 12]);
    auto turned = mesh.triangles[random() % 12];
    std::swap(turned[1], turned[2]);
    mesh.triangles.push_back(turned);
    mesh.triangles.push_back({0, 0, 1});
    mesh.vertices.emplace_back(5, 5, 5);  // used by nothing
    const CompiledModel repaired = Compile(mesh);
    const ModelView m = repaired.View();
    EXPECT_EQ(m.edges.size(), 12U);
    EXPECT_EQ(m.faces.size(), 6U);
    EXPECT_EQ(m.symmetries.size(), 3U);
    EXPECT_FALSE(repaired.notes.empty());
    for (const ModelFace& f : m.faces) EXPECT_GT(f.offset_m, 0);
    EXPECT_EQ(m.diameter_m, reference.View().diameter_m);
  }
}

TEST(ModelCompiler, WeldsVerticesThatRoundingParted) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(-1e-6, 1e-6);
  Mesh mesh = testing::Soup(BoxMesh(0.3, 0.2, 0.15));
  for (auto& v : mesh.vertices) v += Eigen::Vector3d(noise(random), noise(random), noise(random));
  const ModelView m = Compile(mesh).View();
  EXPECT_EQ(m.vertices.size(), 8U);
  EXPECT_EQ(m.edges.size(), 12U);
}

TEST(ModelCompiler, OpenBoxHasABorder) {
  Mesh mesh = BoxMesh(0.3, 0.2, 0.15);
  mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);  // the lid
  const CompiledModel model = Compile(mesh);
  const ModelView m = model.View();
  EXPECT_EQ(m.faces.size(), 5U);
  ASSERT_EQ(m.edges.size(), 12U);
  int borders = 0;
  for (const ModelEdge& e : m.edges) {
    if (e.face[1] != kNoFace) continue;
    ++borders;
    EXPECT_FLOAT_EQ(m.VertexPosition(e.vertex[0]).z(), 0.075F);
    EXPECT_FLOAT_EQ(m.VertexPosition(e.vertex[1]).z(), 0.075F);
  }
  EXPECT_EQ(borders, 4);
  EXPECT_EQ(m.symmetries.size(), 1U);  // only the half turn about z is left
}

TEST(ModelCompiler, TJunctionsLeaveOneStraightEdge) {
  // The front of the box is cut into strips whose corners lie inside the neighbours' edges.
  Mesh mesh = BoxMesh(0.3, 0.2, 0.15);
  mesh.triangles.erase(mesh.triangles.begin() + 4, mesh.triangles.begin() + 6);
  const int cuts = 5, first = static_cast<int>(mesh.vertices.size());
  for (int i = 0; i <= cuts; ++i) {
    for (const double z : {-0.075, 0.075}) mesh.vertices.emplace_back(-0.15 + 0.3 * i / cuts, -0.1, z);
  }
  for (int i = 0; i < cuts; ++i) {
    const int a = first + 2 * i;
    mesh.triangles.push_back({a, a + 2, a + 1});
    mesh.triangles.push_back({a + 1, a + 2, a + 3});
  }
  const CompiledModel model = Compile(mesh);
  EXPECT_EQ(model.View().faces.size(), 6U);
  EXPECT_EQ(model.View().edges.size(), 12U);
  EXPECT_THAT(model.notes, ::testing::Contains(HasSubstr("T-junctions")));
}

TEST(ModelCompiler, TessellatedCylinderHasOnlyItsRims) {
  const CompiledModel model = Compile(testing::PrismMesh(48, 0.05, 0.2));
  const ModelView m = model.View();
  EXPECT_EQ(m.faces.size(), 50U);
  EXPECT_EQ(m.edges.size(), 96U);  // two rims; 7.5 degrees between the strips are no crease
  for (const ModelEdge& e : m.edges) EXPECT_NEAR(e.dihedral_rad, M_PI / 2, 1e-5);
}

TEST(ModelCompiler, HexagonalPrismHasUprightCreases) {
  const ModelView m = Compile(testing::PrismMesh(6, 0.05, 0.2)).View();
  EXPECT_EQ(m.faces.size(), 8U);
  EXPECT_EQ(m.edges.size(), 18U);
  EXPECT_EQ(m.symmetries.size(), 11U);  // the dihedral group of order 12
}

TEST(ModelCompiler, ConcaveCornersAreValleys) {
  // An L-shaped prism: its inner upright edge is the only valley.
  Mesh mesh;
  const double profile[6][2] = {{0, 0}, {0.2, 0}, {0.2, 0.1}, {0.1, 0.1}, {0.1, 0.2}, {0, 0.2}};
  for (const auto& p : profile) {
    for (const double z : {0.0, 0.3}) mesh.vertices.emplace_back(p[0], p[1], z);
  }
  for (int i = 0; i < 6; ++i) {
    const int a = 2 * i, b = 2 * ((i + 1) % 6);
    mesh.triangles.push_back({a, b, a + 1});
    mesh.triangles.push_back({b, b + 1, a + 1});
  }
  for (const auto& t : {std::array{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    mesh.triangles.push_back({2 * t[0], 2 * t[2], 2 * t[1]});
    mesh.triangles.push_back({2 * t[0] + 1, 2 * t[1] + 1, 2 * t[2] + 1});
  }
  const CompiledModel model = Compile(mesh);
  const ModelView m = model.View();
  ASSERT_EQ(m.edges.size(), 18U);
  int valleys = 0;
  for (const ModelEdge& e : m.edges) {
    if (e.convex != 0) continue;
    ++valleys;
    EXPECT_FLOAT_EQ(m.VertexPosition(e.vertex[0]).x(), 0.1F);
    EXPECT_FLOAT_EQ(m.VertexPosition(e.vertex[1]).y(), 0.1F);
  }
  EXPECT_EQ(valleys, 1);
}

TEST(ModelCompiler, EdgesInsideTheObjectAreLeftOut) {
  Mesh mesh = BoxMesh(0.3, 0.2, 0.15);
  testing::Append(BoxMesh(0.1, 0.1, 0.1), mesh);
  const CompiledModel model = Compile(mesh);
  EXPECT_EQ(model.View().edges.size(), 12U);
  EXPECT_THAT(model.notes, ::testing::Contains(HasSubstr("12 edges")));
}

TEST(ModelCompiler, KeepsTheLongestOfTooManyEdges) {
  Mesh mesh;
  for (int i = 0; i < 30; ++i) {  // 360 edges on a shelf, the later the longer
    testing::Append(BoxMesh(0.02, 0.02, 0.02 + 0.001 * i, {0.1 * (i % 6), 0.1 * (i / 6 % 6), 0}), mesh);
  }
  const CompiledModel model = Compile(mesh);
  const ModelView m = model.View();
  ASSERT_EQ(m.edges.size(), kMaxModelEdges);
  EXPECT_FLOAT_EQ(m.edges[0].length_m, 0.049F);
  EXPECT_THAT(model.notes, ::testing::Contains(HasSubstr("longest 256 of 360")));
}

TEST(ModelCompiler, RefusesWhatIsNoObjectAndSaysWhatToDo) {
  EXPECT_THAT(ErrorOf({}), HasSubstr("surface mesh"));
  Mesh flat = BoxMesh(0.3, 0.2, 0.15);
  flat.triangles = {{0, 0, 1}, {2, 2, 3}};
  EXPECT_THAT(ErrorOf(flat), HasSubstr("degenerate"));
  Mesh broken = BoxMesh(0.3, 0.2, 0.15);
  broken.vertices[2].y() = std::nan("");
  EXPECT_THAT(ErrorOf(broken), HasSubstr("not finite"));
  EXPECT_THAT(ErrorOf(testing::PrismMesh(300, 0.1, 0.3)), HasSubstr("simplify"));
  tools::CompileOptions options = TestOptions();
  for (const char* name : {"", "a name of more than thirty-one bytes", "b\nc"}) {
    options.name = name;
    const auto model = CompileModel(BoxMesh(1, 1, 1), options);
    ASSERT_FALSE(model.has_value());
    EXPECT_THAT(model.error(), HasSubstr("--name"));
  }
}

TEST(ModelCompiler, DoubtsSizesThatSuggestTheWrongUnit) {
  EXPECT_THAT(Compile(BoxMesh(3e-4, 2e-4, 1e-4)).notes, ::testing::Contains(HasSubstr("--unit")));
  EXPECT_THAT(Compile(BoxMesh(300, 200, 150)).notes, ::testing::Contains(HasSubstr("--unit")));
}

// --- Files
// --------------------------------------------------------------------------------------------------------------

class ModelFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) / (std::string("wirepose_") + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  std::filesystem::path folder_;
};

std::string PlyText(const Mesh& mesh) {
  std::ostringstream out;
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& v : mesh.vertices) out << v.x() * 1e3 << ' ' << v.y() * 1e3 << ' ' << v.z() * 1e3 << '\n';
  for (const auto& t : mesh.triangles) out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  return out.str();
}

std::string ObjText(const Mesh& mesh, double scale) {
  std::ostringstream out;
  for (const auto& v : mesh.vertices)
    out << "v " << v.x() * scale << ' ' << v.y() * scale << ' ' << v.z() * scale << '\n';
  for (const auto& t : mesh.triangles) out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  return out.str();
}

std::string StlText(const Mesh& mesh) {
  std::ostringstream out;
  out << "solid test\n";
  for (const auto& t : mesh.triangles) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (const int v : t) {
      out << "vertex " << mesh.vertices[v].x() * 1e3 << ' ' << mesh.vertices[v].y() * 1e3 << ' '
          << mesh.vertices[v].z() * 1e3 << '\n';
    }
    out << "endloop\nendfacet\n";
  }
  out << "endsolid test\n";
  return out.str();
}

TEST_F(ModelFiles, PlyObjAndStlGiveTheSameModel) {
  const Mesh mesh = testing::TwoPartMesh();
  const auto ply = CompileModel(Write("a.ply", PlyText(mesh)), TestOptions());
  const auto obj = CompileModel(Write("a.obj", ObjText(mesh, 1e3)), TestOptions());
  const auto stl = CompileModel(Write("a.stl", StlText(mesh)), TestOptions());
  ASSERT_TRUE(ply.has_value() && obj.has_value() && stl.has_value());
  EXPECT_EQ(ply->View().edges.size(), 24U);
  EXPECT_EQ(obj->bytes, ply->bytes);
  EXPECT_EQ(stl->bytes, ply->bytes);
}

TEST_F(ModelFiles, UnitScalesTheModel) {
  tools::CompileOptions options = TestOptions();
  options.unit = tools::MeshUnit::kMetre;
  const auto metres = CompileModel(Write("m.obj", ObjText(BoxMesh(0.3, 0.2, 0.15), 1)), options);
  ASSERT_TRUE(metres.has_value());
  EXPECT_FLOAT_EQ(metres->View().edges[0].length_m, 0.3F);
}

TEST_F(ModelFiles, NameDefaultsToTheFile) {
  const auto model = CompileModel(Write("mug rack.ply", PlyText(BoxMesh(0.3, 0.2, 0.15))), {});
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->View().name, "mug rack");
}

TEST_F(ModelFiles, BadMeshFilesAreNamedWithARemedy) {
  const std::pair<std::filesystem::path, const char*> cases[] = {
      {folder_ / "absent.ply", "no such file"},
      {folder_, "no such file"},
      {Write("empty.ply", ""), "empty"},
      {Write("text.ply", "hello"), "export"},
      {Write("unknown.xyzzy", "hello"), "export"},
      {Write("points.obj", "v 0 0 0\nv 1 0 0\n"), "export"},
      {Write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), "export"},
  };
  for (const auto& [file, what] : cases) {
    const auto model = CompileModel(file, TestOptions());
    ASSERT_FALSE(model.has_value()) << file;
    EXPECT_THAT(model.error(), HasSubstr(file.string()));
    EXPECT_THAT(model.error(), HasSubstr(what));
    EXPECT_EQ(model.error().find('\n'), std::string::npos);
  }
}

TEST_F(ModelFiles, ModelFilesSurviveTheRoundTrip) {
  const CompiledModel model = Compile(BoxMesh(0.3, 0.2, 0.15));
  ASSERT_TRUE(tools::WriteModelFile(folder_ / "box.wpm", model).has_value());
  const auto back = tools::ReadModelFile(folder_ / "box.wpm");
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->bytes, model.bytes);
  std::filesystem::resize_file(folder_ / "box.wpm", 500);
  const auto truncated = tools::ReadModelFile(folder_ / "box.wpm");
  ASSERT_FALSE(truncated.has_value());
  EXPECT_THAT(truncated.error(), HasSubstr("box.wpm"));
  EXPECT_FALSE(tools::ReadModelFile(folder_ / "absent.wpm").has_value());
  EXPECT_FALSE(tools::WriteModelFile(folder_ / "absent" / "box.wpm", model).has_value());
}

TEST_F(ModelFiles, ModelsInfoIsInMillimetres) {
  const CompiledModel box = Compile(BoxMesh(0.3, 0.2, 0.15, {0.1, 0, 0}));
  const ModelView views[] = {box.View()};
  ASSERT_TRUE(tools::WriteModelsInfo(folder_ / "models_info.json", views).has_value());
  std::ifstream in(folder_ / "models_info.json");
  const auto info = nlohmann::json::parse(in).at("7");
  EXPECT_NEAR(info.at("diameter").get<double>(), 390.512, 1e-2);
  EXPECT_NEAR(info.at("min_x").get<double>(), -50, 1e-3);
  EXPECT_NEAR(info.at("size_z").get<double>(), 150, 1e-3);
  ASSERT_EQ(info.at("symmetries_discrete").size(), 3U);
  double largest_shift = 0;
  for (const auto& s : info.at("symmetries_discrete")) largest_shift = std::max(largest_shift, s.at(3).get<double>());
  EXPECT_NEAR(largest_shift, 200, 1e-2);  // a half turn about an axis through (100 mm, 0, 0)
}

}  // namespace
}  // namespace wirepose
