#include "sim/texture.h"

#include <gtest/gtest.h>

#include <set>

#include "sim/random.h"

namespace wirepose::sim {
namespace {

const Bounds kBounds{Vector3(-0.15F, -0.1F, -0.075F), Vector3(0.15F, 0.1F, 0.075F)};

Vector3 AnyPoint(Random& random) {
  Vector3 p;
  for (int i = 0; i < 3; ++i) {
    p[i] = static_cast<float>(random.Uniform(double{kBounds.low[i]}, double{kBounds.high[i]}));
  }
  return p;
}

TEST(Texture, AlbedoStaysInRangeAndIsAFunctionOfThePlace) {
  Random random(31);
  for (const Texture texture :
       {Texture::kPlain, Texture::kWood, Texture::kStone, Texture::kTiles, Texture::kPanels, Texture::kChecker,
        Texture::kLabel, Texture::kMarble, Texture::kSteel, Texture::kParcel, Texture::kGrocery, Texture::kBook,
        Texture::kPoster, Texture::kFridge, Texture::kParts}) {
    for (const Mapping mapping : {Mapping::kBox, Mapping::kCylinder}) {
      for (std::uint32_t seed = 0; seed < 8; ++seed) {
        const Material material{texture, mapping, 0.9F, 0.1F, 0.03F, 0.1F, seed};
        for (int i = 0; i < 500; ++i) {
          const Vector3 p = AnyPoint(random);
          const Vector3 n = Vector3(p.x(), p.y(), 0.02F).normalized();
          const float albedo = AlbedoAt(material, kBounds, p, n);
          ASSERT_GE(albedo, 0);
          ASSERT_LE(albedo, 1);
          ASSERT_EQ(albedo, AlbedoAt(material, kBounds, p, n));
        }
      }
    }
  }
}

TEST(Texture, CheckerAlternates) {
  const Material material{Texture::kChecker, Mapping::kBox, 0.8F, 0.2F, 0.05F, 0, 0};
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 4; ++j) {
      const Vector3 p(-0.15F + 0.05F * (static_cast<float>(i) + 0.5F), -0.1F + 0.05F * (static_cast<float>(j) + 0.5F),
                      0.075F);
      EXPECT_EQ(AlbedoAt(material, kBounds, p, Vector3::UnitZ()), (i + j) % 2 == 0 ? 0.8F : 0.2F);
    }
  }
}

TEST(Texture, TilesHaveJoints) {
  const Material material{Texture::kTiles, Mapping::kBox, 0.8F, 0.2F, 0.1F, 0, 0};
  const Vector3 joint(-0.15F + 0.1F + 0.001F, 0.03F, 0.075F), tile(-0.1F, 0.05F, 0.075F);
  EXPECT_EQ(AlbedoAt(material, kBounds, joint, Vector3::UnitZ()), 0.2F);
  EXPECT_GT(AlbedoAt(material, kBounds, tile, Vector3::UnitZ()), 0.7F);
}

TEST(Texture, InstancesOfOneTextureDiffer) {
  const Vector3 p(0.031F, 0.012F, 0.075F);
  std::set<float> seen;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const Material material{Texture::kStone, Mapping::kBox, 0.5F, 0.2F, 0.03F, 0, seed};
    seen.insert(AlbedoAt(material, kBounds, p, Vector3::UnitZ()));
  }
  EXPECT_GT(seen.size(), 15U);
}

}  // namespace
}  // namespace wirepose::sim
