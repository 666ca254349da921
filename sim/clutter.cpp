#include "sim/clutter.h"

#include "sim/shapes.h"

namespace wirepose::sim {
namespace {

Material Surface(Random& random, Texture texture, const Range& albedo, const Range& gloss) {
  Material m;
  m.texture = texture;
  m.albedo = DrawFloat(random, albedo);
  m.second_albedo = StandOut(random, m.albedo);
  m.gloss = DrawFloat(random, gloss);
  m.roughness = DrawFloat(random, {0.1, 0.4});
  m.seed = DrawSeed(random);
  return m;
}

Thing Can(Random& random) {
  Material m = Surface(random, random.Chance(0.7) ? Texture::kGrocery : Texture::kPlain, {0.1, 0.8}, {0, 0.1});
  m.mapping = Mapping::kCylinder;
  return {MakeCylinder(DrawFloat(random, {0.03, 0.05}), DrawFloat(random, {0.08, 0.16}), 64), m};
}

Thing Bottle(Random& random) {
  Material m = Surface(random, random.Chance(0.5) ? Texture::kGrocery : Texture::kPlain, {0.05, 0.7}, {0.03, 0.08});
  m.mapping = Mapping::kCylinder;
  return {MakeBottle(DrawFloat(random, {0.032, 0.045}), DrawFloat(random, {0.2, 0.32})), m};
}

Thing Mug(Random& random) {
  return {MakeMug(DrawFloat(random, {0.035, 0.045}), DrawFloat(random, {0.08, 0.11})),
          Surface(random, Texture::kPlain, {0.06, 0.85}, {0.03, 0.06})};
}

Thing Plates(Random& random) {
  return {MakePlates(DrawFloat(random, {0.09, 0.14}), 1 + random.Below(5)),
          Surface(random, Texture::kPlain, {0.15, 0.85}, {0.03, 0.06})};
}

Thing Bowl(Random& random) {
  return {MakeBowl(DrawFloat(random, {0.08, 0.14}), DrawFloat(random, {0.05, 0.09})),
          Surface(random, random.Chance(0.3) ? Texture::kWood : Texture::kPlain, {0.1, 0.85}, {0.02, 0.06})};
}

Thing Carton(Random& random) {
  const Vector3 size(DrawFloat(random, {0.1, 0.21}), DrawFloat(random, {0.05, 0.08}), DrawFloat(random, {0.16, 0.32}));
  return {MakeBox(size), Surface(random, Texture::kGrocery, {0.1, 0.85}, {0, 0.04}), true};
}

Thing SmallBox(Random& random) {
  const Vector3 size(DrawFloat(random, {0.05, 0.14}), DrawFloat(random, {0.04, 0.1}), DrawFloat(random, {0.03, 0.14}));
  return {MakeBox(size),
          Surface(random, random.Chance(0.7) ? Texture::kGrocery : Texture::kPlain, {0.1, 0.85}, {0, 0.04}), true};
}

Thing Milk(Random& random) {
  const float side = DrawFloat(random, {0.065, 0.095});
  return {MakeGableCarton({side, side, DrawFloat(random, {0.2, 0.27})}),
          Surface(random, Texture::kGrocery, {0.3, 0.85}, {0, 0.05})};
}

// Other formats than 240 x 165 x 35.
Thing OtherBook(Random& random) {
  const float height = random.Chance(0.5) ? DrawFloat(random, {0.17, 0.21}) : DrawFloat(random, {0.27, 0.32});
  const Vector3 size(height, height * DrawFloat(random, {0.74, 0.95}), DrawFloat(random, {0.012, 0.05}));
  return {MakeBox(size), Surface(random, Texture::kBook, {0.08, 0.8}, {0, 0.05}), true};
}

Thing Board(Random& random) {
  Material m = Surface(random, Texture::kWood, {0.25, 0.6}, {0, 0.02});
  m.scale_m = DrawFloat(random, {0.04, 0.12});
  return {
      MakeBox({DrawFloat(random, {0.25, 0.42}), DrawFloat(random, {0.16, 0.28}), DrawFloat(random, {0.012, 0.025})}),
      m};
}

Thing Roll(Random& random) {
  return {MakeCylinder(DrawFloat(random, {0.05, 0.065}), DrawFloat(random, {0.21, 0.27}), 64),
          Surface(random, Texture::kPlain, {0.7, 0.88}, {0, 0})};
}

Thing KnifeBlock(Random& random) {
  Material m = Surface(random, random.Chance(0.7) ? Texture::kWood : Texture::kPlain, {0.08, 0.6}, {0, 0.03});
  m.scale_m = 0.5F;
  return {MakeKnifeBlock({0.09F, 0.13F, DrawFloat(random, {0.18, 0.25})}), m};
}

Thing Toaster(Random& random) {
  Material m = Surface(random, random.Chance(0.5) ? Texture::kSteel : Texture::kPlain, {0.08, 0.6}, {0.04, 0.25});
  Mesh mesh =
      MakeBox({DrawFloat(random, {0.26, 0.34}), DrawFloat(random, {0.15, 0.2}), DrawFloat(random, {0.17, 0.22})});
  const Vector3 top = mesh.Max();
  for (const float y : {-0.03F, 0.03F}) Append(mesh, MakeBox({1.5F * top.x(), 0.02F, 0.008F}), {0, y, top.z()});
  Append(mesh, MakeBox({0.02F, 0.04F, 0.02F}), {top.x() + 0.01F, 0, 0.4F * top.z()});
  return {mesh, m};
}

}  // namespace

Thing DrawThing(Random& random) {
  using Maker = Thing (*)(Random&);
  static const std::vector<Maker> makers = {Can,      Can,       Bottle, Mug,    Mug,        Plates,
                                            Bowl,     Carton,    Carton, Carton, Milk,       SmallBox,
                                            SmallBox, OtherBook, Board,  Roll,   KnifeBlock, Toaster};
  return DrawOne(random, makers)(random);
}

Thing DrawOccluder(Random& random) {
  using Maker = Thing (*)(Random&);
  static const std::vector<Maker> makers = {Can,  Bottle, Carton,     Carton,  SmallBox,
                                            Milk, Roll,   KnifeBlock, Toaster, Bowl};
  return DrawOne(random, makers)(random);
}

}  // namespace wirepose::sim
