#include "model/model_parser.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <set>
#include <string>

#include "tests/mesh/test_meshes.h"
#include "tests/model/model_consistency.h"
#include "tests/tools/model_test_options.h"
#include "tools/model_compiler/model_writer.h"

namespace wirepose {
namespace {

using testing::FindInconsistency;
using Bytes = std::vector<std::byte>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

const Bytes& GoodModel() {
  static const Bytes bytes =
      tools::CompileModel(testing::BoxMesh(0.3, 0.2, 0.15), testing::TestOptions()).value().bytes;
  return bytes;
}

ModelFileHeader& Header(Bytes& file) { return *reinterpret_cast<ModelFileHeader*>(file.data()); }

template <typename Record>
Record& At(Bytes& file, const ModelSection& section, std::size_t i = 0) {
  return reinterpret_cast<Record*>(file.data() + section.offset)[i];
}

TEST(ModelParser, ReadsAGoodModelInPlace) {
  const Bytes& file = GoodModel();
  const auto model = ParseModel(file);
  ASSERT_TRUE(model.has_value()) << Describe(model.error());
  EXPECT_EQ(FindInconsistency(*model), nullptr);
  EXPECT_EQ(model->id, 7U);
  EXPECT_EQ(model->name, "test object");
  EXPECT_EQ(model->vertices.size(), 8U);
  EXPECT_EQ(model->edges.size(), 12U);
  const auto* first_vertex = reinterpret_cast<const std::byte*>(model->vertices.data());
  EXPECT_TRUE(first_vertex >= file.data() && first_vertex < file.data() + file.size());
}

TEST(ModelParser, RefusesEveryTruncation) {
  for (std::size_t size = 0; size < GoodModel().size(); ++size) {
    const Bytes file(GoodModel().begin(), GoodModel().begin() + static_cast<std::ptrdiff_t>(size));
    const auto model = ParseModel(file);
    ASSERT_FALSE(model.has_value()) << size;
    ASSERT_EQ(model.error(), size < sizeof(ModelFileHeader) ? ModelError::kTooShort : ModelError::kWrongSize) << size;
  }
}

TEST(ModelParser, RefusesResealedTruncations) {  // size and checksum say that all is well
  for (std::size_t size = sizeof(ModelFileHeader); size < GoodModel().size(); ++size) {
    Bytes file(GoodModel().begin(), GoodModel().begin() + static_cast<std::ptrdiff_t>(size));
    tools::SealModel(file);
    const auto model = ParseModel(file);
    ASSERT_FALSE(model.has_value()) << size;
    ASSERT_EQ(model.error(), ModelError::kBadSection) << size;
  }
}

TEST(ModelParser, RefusesAnyFlippedBit) {
  for (std::size_t i = 0; i < GoodModel().size(); ++i) {
    Bytes file = GoodModel();
    file[i] ^= static_cast<std::byte>(1U << (i % 8));
    ASSERT_FALSE(ParseModel(file).has_value()) << "byte " << i;
  }
}

TEST(ModelParser, RefusesMisalignedBytes) {
  Bytes shifted(GoodModel().size() + 1);
  std::copy(GoodModel().begin(), GoodModel().end(), shifted.begin() + 1);
  const auto model = ParseModel(std::span<const std::byte>(shifted).subspan(1));
  ASSERT_FALSE(model.has_value());
  EXPECT_EQ(model.error(), ModelError::kMisaligned);
}

TEST(ModelParser, AcceptsEveryHeaderByteOnlyIfTheViewIsConsistent) {
  for (std::size_t i = 0; i < sizeof(ModelFileHeader); ++i) {
    for (int value = 0; value < 256; value += value < 16 || value >= 250 ? 1 : 13) {
      Bytes file = GoodModel();
      file[i] = static_cast<std::byte>(value);
      tools::SealModel(file);
      if (const auto model = ParseModel(file)) {
        ASSERT_EQ(FindInconsistency(*model), nullptr) << i << ' ' << value;
      }
    }
  }
}

struct Corruption {
  const char* what;
  ModelError expected;
  std::function<void(Bytes&)> apply;
};

const std::vector<Corruption>& Corruptions() {
  static const std::vector<Corruption> all = {
      {"magic", ModelError::kNotAModel, [](Bytes& f) { Header(f).magic = 0; }},
      {"version", ModelError::kWrongVersion, [](Bytes& f) { Header(f).version = kModelVersion + 1; }},
      {"empty name", ModelError::kBadName, [](Bytes& f) { Header(f).name[0] = 0; }},
      {"open name", ModelError::kBadName, [](Bytes& f) { std::memset(Header(f).name, 'a', kMaxModelName); }},
      {"name bytes", ModelError::kBadName, [](Bytes& f) { Header(f).name[1] = '\n'; }},
      {"misaligned section", ModelError::kBadSection, [](Bytes& f) { Header(f).faces.offset += 4; }},
      {"section in header", ModelError::kBadSection, [](Bytes& f) { Header(f).vertices.offset = 8; }},
      {"section overlap", ModelError::kBadSection,
       [](Bytes& f) {
         Header(f).faces = Header(f).triangles;
         Header(f).faces.count = 6;
       }},
      {"section outside", ModelError::kBadSection, [](Bytes& f) { Header(f).aspects.offset = 0xFFFFFFF8U; }},
      {"too many vertices", ModelError::kOverCapacity,
       [](Bytes& f) { Header(f).vertices.count = kMaxModelVertices + 1; }},
      {"too many aspects", ModelError::kOverCapacity, [](Bytes& f) { Header(f).aspects.count = 0xFFFFFFFFU; }},
      {"no edges", ModelError::kEmpty, [](Bytes& f) { Header(f).edges.count = 0; }},
      {"diameter 0", ModelError::kBadDimensions, [](Bytes& f) { Header(f).diameter_m = 0; }},
      {"diameter nan", ModelError::kBadDimensions, [](Bytes& f) { Header(f).diameter_m = kNan; }},
      {"diameter beyond box", ModelError::kBadDimensions, [](Bytes& f) { Header(f).diameter_m *= 2; }},
      {"box", ModelError::kBadDimensions, [](Bytes& f) { std::swap(Header(f).box_min_m[1], Header(f).box_max_m[1]); }},
      {"box infinite", ModelError::kBadDimensions, [](Bytes& f) { Header(f).box_max_m[2] = kInfinity; }},
      {"vertex nan", ModelError::kBadVertex, [](Bytes& f) { At<ModelVertex>(f, Header(f).vertices, 3).y = kNan; }},
      {"vertex outside", ModelError::kBadVertex, [](Bytes& f) { At<ModelVertex>(f, Header(f).vertices, 3).y = 9; }},
      {"triangle vertex", ModelError::kBadTriangle,
       [](Bytes& f) { At<ModelTriangle>(f, Header(f).triangles).vertex[2] = 8; }},
      {"triangle face", ModelError::kBadTriangle, [](Bytes& f) { At<ModelTriangle>(f, Header(f).triangles).face = 6; }},
      {"triangle degenerate", ModelError::kBadTriangle,
       [](Bytes& f) {
         auto& t = At<ModelTriangle>(f, Header(f).triangles);
         t.vertex[0] = t.vertex[1];
       }},
      {"face normal", ModelError::kBadFace, [](Bytes& f) { At<ModelFace>(f, Header(f).faces).normal[0] += 1; }},
      {"face normal nan", ModelError::kBadFace, [](Bytes& f) { At<ModelFace>(f, Header(f).faces).normal[1] = kNan; }},
      {"face offset", ModelError::kBadFace,
       [](Bytes& f) { At<ModelFace>(f, Header(f).faces, 5).offset_m = -kInfinity; }},
      {"face area", ModelError::kBadFace, [](Bytes& f) { At<ModelFace>(f, Header(f).faces, 5).area_m2 = kNan; }},
      {"face range", ModelError::kBadFace, [](Bytes& f) { At<ModelFace>(f, Header(f).faces, 5).triangle_count = 3; }},
      {"face start", ModelError::kBadFace, [](Bytes& f) { At<ModelFace>(f, Header(f).faces, 2).first_triangle = 3; }},
      {"triangle of other face", ModelError::kBadFace,
       [](Bytes& f) { At<ModelTriangle>(f, Header(f).triangles).face = 1; }},
      {"edge vertex", ModelError::kBadEdge, [](Bytes& f) { At<ModelEdge>(f, Header(f).edges).vertex[0] = 0xFFFF; }},
      {"edge face", ModelError::kBadEdge, [](Bytes& f) { At<ModelEdge>(f, Header(f).edges).face[1] = 6; }},
      {"edge first face", ModelError::kBadEdge, [](Bytes& f) { At<ModelEdge>(f, Header(f).edges).face[0] = kNoFace; }},
      {"edge length", ModelError::kBadEdge, [](Bytes& f) { At<ModelEdge>(f, Header(f).edges).length_m = 0.31F; }},
      {"edge order", ModelError::kBadEdge,
       [](Bytes& f) { std::swap(At<ModelEdge>(f, Header(f).edges, 0), At<ModelEdge>(f, Header(f).edges, 11)); }},
      {"edge dihedral", ModelError::kBadEdge,
       [](Bytes& f) { At<ModelEdge>(f, Header(f).edges, 2).dihedral_rad = kNan; }},
      {"edge convexity", ModelError::kBadEdge, [](Bytes& f) { At<ModelEdge>(f, Header(f).edges, 2).convex = 2; }},
      {"set kind", ModelError::kBadLineSet,
       [](Bytes& f) { At<ModelLineSet>(f, Header(f).line_sets).kind = static_cast<LineSetKind>(2); }},
      {"set base", ModelError::kBadLineSet, [](Bytes& f) { At<ModelLineSet>(f, Header(f).line_sets).base_edge = 12; }},
      {"set range", ModelError::kBadLineSet,
       [](Bytes& f) { At<ModelLineSet>(f, Header(f).line_sets, 23).member_count += 1; }},
      {"set overflow", ModelError::kBadLineSet,
       [](Bytes& f) { At<ModelLineSet>(f, Header(f).line_sets, 3).member_count = 0xFFFFFFFFU; }},
      {"member edge", ModelError::kBadSetMember,
       [](Bytes& f) { At<ModelSetMember>(f, Header(f).set_members, 9).edge = 12; }},
      {"member angle", ModelError::kBadSetMember,
       [](Bytes& f) { At<ModelSetMember>(f, Header(f).set_members).angle_rad = 2; }},
      {"member distance", ModelError::kBadSetMember,
       [](Bytes& f) { At<ModelSetMember>(f, Header(f).set_members).distance_m = kNan; }},
      {"member ends", ModelError::kBadSetMember,
       [](Bytes& f) { At<ModelSetMember>(f, Header(f).set_members).farthest_end_m = -1; }},
      {"mirror", ModelError::kBadSymmetry,
       [](Bytes& f) {
         for (float& r : At<ModelSymmetry>(f, Header(f).symmetries).rotation) r = -r;
       }},
      {"scaling", ModelError::kBadSymmetry,
       [](Bytes& f) { At<ModelSymmetry>(f, Header(f).symmetries, 1).rotation[4] *= 0.9F; }},
      {"translation", ModelError::kBadSymmetry,
       [](Bytes& f) { At<ModelSymmetry>(f, Header(f).symmetries).translation_m[1] = kInfinity; }},
      {"aspect direction", ModelError::kBadAspect,
       [](Bytes& f) { At<ModelAspect>(f, Header(f).aspects, 5).direction[0] += 2; }},
      {"aspect distance", ModelError::kBadAspect,
       [](Bytes& f) { At<ModelAspect>(f, Header(f).aspects, 5).distance_m = kNan; }},
      {"aspect bits", ModelError::kBadAspect,
       [](Bytes& f) { At<ModelAspect>(f, Header(f).aspects, 161).visible_edges[0] |= 1U << 12; }},
  };
  return all;
}

TEST(ModelParser, NamesEveryKindOfCorruption) {
  for (const Corruption& corruption : Corruptions()) {
    Bytes file = GoodModel();
    corruption.apply(file);
    tools::SealModel(file);
    const auto model = ParseModel(file);
    ASSERT_FALSE(model.has_value()) << corruption.what;
    EXPECT_STREQ(Describe(model.error()), Describe(corruption.expected)) << corruption.what;
  }
}

TEST(ModelParser, DescribesEveryErrorDifferentlyInOneLine) {
  std::set<std::string> texts;
  for (int e = 0; e <= static_cast<int>(ModelError::kBadAspect); ++e) {
    const std::string text = Describe(static_cast<ModelError>(e));
    EXPECT_GT(text.size(), 20U);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    texts.insert(text);
  }
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(ModelError::kBadAspect) + 1);
}

TEST(ModelParser, AcceptsAModelAtItsCapacityAndRefusesOneBeyond) {
  Bytes file = GoodModel();
  EXPECT_EQ(Header(file).aspects.count, kMaxModelAspects);
  EXPECT_TRUE(ParseModel(file).has_value());
  Header(file).aspects.count = kMaxModelAspects + 1;
  file.resize(file.size() + sizeof(ModelAspect));
  tools::SealModel(file);
  const auto model = ParseModel(file);
  ASSERT_FALSE(model.has_value());
  EXPECT_EQ(model.error(), ModelError::kOverCapacity);
}

}  // namespace
}  // namespace wirepose
