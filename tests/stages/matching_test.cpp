// Correspondences and hypotheses: from perfect lines of a model at random poses the true pose must
// be found.
#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

#include "model_test_support.h"
#include "stages/correspondences.h"
#include "stages/hypotheses.h"

namespace wirepose {
namespace {

using testing::Cases;
using testing::IdealScene;
using testing::Random;
using testing::TestModel;

struct Matching {
  ImageLineSets sets;
  CorrespondingPairs pairs;
  Hypotheses hypotheses;
};

void Match(const PreparedModel& model, const IdealScene& scene, Matching& out) {
  FindLineSets({}, scene.camera, scene.lines, out.sets);
  FindCorrespondences({}, scene.camera, model, scene.lines, out.sets, out.pairs);
  MakeHypotheses({}, {scene.camera, scene.left, scene.right}, model, scene.lines, out.sets, out.pairs.Sorted(),
                 out.hypotheses);
}

Pose PoseOf(const Hypothesis& h) { return {h.R.cast<double>(), h.t.cast<double>()}; }

double NearestError(const PreparedModel& model, Hypotheses& hypotheses, const Pose& truth) {
  double best = 1e9;
  for (const Hypothesis& h : hypotheses.items()) best = std::min(best, testing::CornerError(model, PoseOf(h), truth));
  return best;
}

// Index of the edge onto which the symmetry carries edge `e`.
std::size_t Carried(const PreparedModel& model, const Pose& symmetry, std::size_t e) {
  const Vector3d a = symmetry * model.edges[e].a.cast<double>(), b = symmetry * model.edges[e].b.cast<double>();
  for (std::size_t f = 0; f < model.edges.size(); ++f) {
    const Vector3d p = model.edges[f].a.cast<double>(), q = model.edges[f].b.cast<double>();
    if ((a - p).norm() + (b - q).norm() < 1e-4 || (a - q).norm() + (b - p).norm() < 1e-4) return f;
  }
  ADD_FAILURE() << "symmetry does not map edges onto edges";
  return 0;
}

void TruePoseIsAmongHypotheses(const std::string& name, double min_share) {
  const TestModel model = testing::Load(name);
  const auto matching = std::make_unique<Matching>();
  Random random(1);
  const int count = Cases(40);
  int hits = 0;
  for (int k = 0; k < count; ++k) {
    const Pose T = testing::AnyView(random, *model, testing::TestCamera(), 300);
    const auto scene = testing::MakeScene(random, *model, T);
    Match(*model, *scene, *matching);
    EXPECT_LE(matching->hypotheses.size(), kMaxHypotheses);
    if (NearestError(*model, matching->hypotheses, T) < 0.1 * static_cast<double>(model->view.diameter_m)) ++hits;
  }
  printf("%s: true pose among the hypotheses in %d of %d views\n", name.c_str(), hits, count);
  EXPECT_GE(hits, min_share * count);
}

TEST(HypothesisMaking, FindsTheBox) { TruePoseIsAmongHypotheses("parcel_box", 0.95); }
TEST(HypothesisMaking, FindsTheBook) { TruePoseIsAmongHypotheses("book", 0.9); }
TEST(HypothesisMaking, FindsTheDispenser) { TruePoseIsAmongHypotheses("juice_dispenser", 0.9); }

// Of every two image lines with depth, the model edges that they truly are (or symmetric ones) are
// proposed.
TEST(CorrespondenceFinding, TrueEdgesAreProposed) {
  Random random(2);
  for (const char* name : {"parcel_box", "book"}) {
    const TestModel model = testing::Load(name);
    const auto matching = std::make_unique<Matching>();
    int asked = 0, found = 0;
    for (int k = 0; k < Cases(20); ++k) {
      const Pose T = testing::AnyView(random, *model, testing::TestCamera(), 300);
      const auto scene = testing::MakeScene(random, *model, T, {.clutter = 0});
      Match(*model, *scene, *matching);
      for (std::size_t p = 0; p < matching->sets.pairs.size(); ++p) {
        const ImageLinePair& pair = matching->sets.pairs[p];
        if (!pair.metric) continue;
        ++asked;
        bool proposed = false;
        for (const Pose& symmetry : model->symmetries) {
          const std::size_t base = Carried(*model, symmetry, static_cast<std::size_t>(scene->edge_of_line[pair.base]));
          const std::size_t other =
              Carried(*model, symmetry, static_cast<std::size_t>(scene->edge_of_line[pair.other]));
          for (const CorrespondingPair& c : matching->pairs.items()) {
            proposed = proposed || (c.image_pair == p && c.base_edge == base && c.other_edge == other);
          }
        }
        found += proposed ? 1 : 0;
      }
    }
    printf("%s: true edges proposed for %d of %d pairs\n", name, found, asked);
    EXPECT_GT(asked, Cases(20) * 5);
    EXPECT_GE(found, 0.95 * asked) << name;
  }
}

// Image pair, base edge, other edge, base flipped.
using Match4 = std::array<int, 4>;

// Every correspondence by the rules, from the model file's own line sets; what rounding may decide either way goes into
// `open`.
class BruteForce {
 public:
  BruteForce(const PreparedModel& model, const IdealScene& scene, const ImageLineSets& sets)
      : model_(model), scene_(scene), sets_(sets) {
    for (const ModelLineSet& set : model.view.line_sets) {
      if (!model.edges[set.base_edge].representative) continue;
      for (const ModelSetMember& member : model.view.set_members.subspan(set.first_member, set.member_count)) {
        for (std::size_t p = 0; p < sets.pairs.size(); ++p) Try(p, set, member);
      }
    }
  }
  std::set<Match4> sure, open;

 private:
  void Try(std::size_t p, const ModelLineSet& set, const ModelSetMember& member) {
    const ImageLinePair& pair = sets_.pairs[p];
    if (pair.kind != set.kind) return;
    const PreparedEdge &base = model_.edges[set.base_edge], &other = model_.edges[member.edge];
    margin_ = 1e9;
    Fits(scene_.lines[pair.base], base, params_.min_cover);
    const int end = SharedEnd(base, other);
    const bool corner = end != 2 && pair.base_end != LineEnd::kNone;
    if (pair.metric) {
      const double slack = Number(params_.end_tolerance_m + params_.sigmas * pair.distance_sigma_m);
      const double longest = 1 + Number(params_.length_tolerance), shortest = 1 - Number(params_.length_tolerance);
      Fits(scene_.lines[pair.other], other, params_.min_other_cover);
      AtLeast(Number(member.distance_m) * longest + slack, Number(pair.distance_m));
      AtLeast(Number(pair.distance_m) + slack, Number(member.distance_m) * shortest);
      AtLeast(Number(params_.angle_tolerance_rad + params_.sigmas * pair.angle_sigma_rad),
              std::abs(Number(pair.angle_rad) - Number(member.angle_rad)));
      AtLeast(Number(member.farthest_end_m) * longest + slack, Number(pair.farthest_end_m));
    } else if (!corner) {
      return;
    }
    if (margin_ < -1e-5) return;
    for (int flipped = 0; flipped < 2; ++flipped) {
      if (corner && flipped != (end == static_cast<int>(pair.base_end) ? 0 : 1)) continue;
      (margin_ > 1e-5 ? sure : open).insert({static_cast<int>(p), set.base_edge, member.edge, flipped});
    }
  }

  static double Number(float value) { return static_cast<double>(value); }
  void AtLeast(double more, double less) { margin_ = std::min(margin_, more - less); }

  void Fits(const Line3& line, const PreparedEdge& edge, float min_cover) {
    const double length = Number(line.Length()), edge_length = Number(edge.length_m);
    const double metres_per_px = 0.5 * Number(line.a.z() + line.b.z()) / scene_.camera.f;
    const double slack = Number(params_.end_tolerance_m) + 2 * metres_per_px +
                         Number(params_.sigmas * DirectionSigma(scene_.camera, line)) * length;
    AtLeast(edge_length * (1 + Number(params_.length_tolerance)) + slack, length);
    AtLeast(length + slack, Number(min_cover) * edge_length);
  }

  [[nodiscard]] int SharedEnd(const PreparedEdge& base, const PreparedEdge& other) const {
    int shared = 2;
    for (int end = 0; end < 2; ++end) {
      for (const Vector3& q : {other.a, other.b}) {
        if (((end == 0 ? base.a : base.b) - q).norm() < 0.02F * model_.view.diameter_m) shared = end;
      }
    }
    return shared;
  }

  const CorrespondenceParams params_;
  const PreparedModel& model_;
  const IdealScene& scene_;
  const ImageLineSets& sets_;
  double margin_ = 0;
};

// As long as none is dropped, the list is what a search through all combinations finds.
TEST(CorrespondenceFinding, AgreesWithBruteForce) {
  Random random(6);
  std::size_t compared = 0;
  for (const char* name : {"parcel_box", "book", "juice_dispenser"}) {
    const TestModel model = testing::Load(name);
    const auto matching = std::make_unique<Matching>();
    for (int k = 0; k < Cases(20); ++k) {
      const auto scene = testing::MakeScene(
          random, *model, testing::AnyView(random, *model, testing::TestCamera(), 250), {.clutter = k % 3 * 3});
      Match(*model, *scene, *matching);
      if (matching->pairs.dropped() > 0) continue;
      const BruteForce expected(*model, *scene, matching->sets);
      std::set<Match4> found;
      for (const CorrespondingPair& c : matching->pairs.items())
        found.insert({c.image_pair, c.base_edge, c.other_edge, c.base_flipped});
      EXPECT_EQ(found.size(), matching->pairs.items().size()) << "something is listed twice";
      for (const Match4& match : expected.sure) EXPECT_TRUE(found.contains(match)) << name << " " << match[1];
      for (const Match4& match : found)
        EXPECT_TRUE(expected.sure.contains(match) || expected.open.contains(match)) << name << " " << match[1];
      compared += expected.sure.size();
    }
  }
  EXPECT_GT(compared, static_cast<std::size_t>(Cases(20)) * 100);
}

// The rank, made of parts as they become known, is the sum of the weighted terms; and no pair has more than its bound
// says: what is pruned by it could not have been kept.
TEST(CorrespondenceFinding, RankIsTheWeightedSumOfItsTerms) {
  Random random(8);
  std::array<int, kPairClasses> compared{};
  for (const char* name : {"parcel_box", "juice_dispenser"}) {
    const TestModel model = testing::Load(name);
    const auto matching = std::make_unique<Matching>();
    for (int k = 0; k < Cases(10); ++k) {
      const auto scene = testing::MakeScene(
          random, *model, testing::AnyView(random, *model, testing::TestCamera(), 250), {.clutter = k % 3 * 3});
      Match(*model, *scene, *matching);
      const auto ranker = std::make_unique<PairRanker>(DefaultPairWeights(), *model, scene->lines);
      for (const CorrespondingPair& match : matching->pairs.Sorted()) {
        const PairClass c = ClassOf(matching->sets.pairs[match.image_pair], match.junction != 0);
        const PairWeights& weights = DefaultPairWeights()[static_cast<std::size_t>(c)];
        const PairTerms terms = TermsOf(*model, scene->lines, matching->sets, match);
        float rank = weights.bias;
        for (std::size_t i = 0; i < kPairTerms; ++i) rank += weights.of[i] * terms[i];
        ASSERT_NEAR(match.rank, rank, 2e-3F) << name << " class " << static_cast<int>(c);
        const float known = ranker->OfPair(c, matching->sets.pairs[match.image_pair]) +
                            ranker->OfBase(c, match.base_edge, terms[static_cast<std::size_t>(PairTerm::kBaseCover)]);
        const ImageLinePair& pair = matching->sets.pairs[match.image_pair];
        const float other_m = pair.metric ? scene->lines[pair.other].Length() : 0;
        ASSERT_LE(match.rank, known + ranker->Most(c, pair, other_m));
        ++compared[static_cast<std::size_t>(c)];
      }
    }
  }
  for (const int count : compared) EXPECT_GT(count, 20);
}

// Ranks of all pairs that can be among the best, by falling order: each base line has a list of its own.
std::vector<float> AllRanks(const CorrespondenceParams& params, const IdealScene& scene, const PreparedModel& model,
                            const ImageLineSets& sets) {
  const auto one_base = std::make_unique<ImageLineSets>();
  const auto pairs = std::make_unique<CorrespondingPairs>();
  std::vector<float> ranks;
  for (std::size_t base = 0; base < scene.lines.size(); ++base) {
    one_base->pairs.clear();
    for (const ImageLinePair& pair : sets.OfBase(base)) one_base->pairs.push_back(pair);
    for (std::size_t b = 0; b < one_base->first.size(); ++b)
      one_base->first[b] = static_cast<std::uint16_t>(b <= base ? 0 : one_base->pairs.size());
    if (one_base->pairs.empty()) continue;
    FindCorrespondences(params, scene.camera, model, scene.lines, *one_base, *pairs);
    for (const CorrespondingPair& match : pairs->items()) ranks.push_back(match.rank);
  }
  std::sort(ranks.rbegin(), ranks.rend());
  return ranks;
}

// What is not made because it could not be kept is none of the best. Without promotions, which only count what is made.
TEST(CorrespondenceFinding, PruningLosesNoneOfTheBest) {
  const TestModel model = testing::Load("juice_dispenser");
  CorrespondenceParams params;
  for (PairWeights& weights : params.rank) weights.of[static_cast<std::size_t>(PairTerm::kPromotion)] = 0;
  Random random(9);
  const auto matching = std::make_unique<Matching>();
  int pruned = 0;
  for (int k = 0; k < Cases(6); ++k) {
    const auto scene = testing::MakeScene(random, *model, testing::AnyView(random, *model, testing::TestCamera(), 250),
                                          {.clutter = 80});
    FindLineSets({}, scene->camera, scene->lines, matching->sets);
    FindCorrespondences(params, scene->camera, *model, scene->lines, matching->sets, matching->pairs);
    if (matching->pairs.dropped() == 0) continue;
    ++pruned;
    const std::vector<float> expected = AllRanks(params, *scene, *model, matching->sets);
    const auto kept = matching->pairs.Sorted();
    ASSERT_EQ(kept.size(), kMaxCorrespondences);
    ASSERT_GT(expected.size(), kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) ASSERT_EQ(kept[i].rank, expected[i]) << "place " << i;
  }
  EXPECT_GT(pruned, 0);
}

// A cuboid of three different sides has three kinds of edges; the other nine would only repeat
// their hypotheses.
TEST(CorrespondenceFinding, SymmetricDuplicatesAreNotSearchedTwice) {
  const TestModel model = testing::Load("parcel_box");
  int representatives = 0;
  for (const PreparedEdge& edge : model->edges) representatives += edge.representative ? 1 : 0;
  EXPECT_EQ(representatives, 3);
  Random random(3);
  const auto matching = std::make_unique<Matching>();
  const auto scene = testing::MakeScene(random, *model, testing::AnyView(random, *model, testing::TestCamera(), 300));
  Match(*model, *scene, *matching);
  ASSERT_GT(matching->pairs.items().size(), 0U);
  for (const CorrespondingPair& c : matching->pairs.items()) EXPECT_TRUE(model->edges[c.base_edge].representative);
  for (const Hypothesis& h : matching->hypotheses.items()) EXPECT_TRUE(model->edges[h.base_edge].representative);
}

// A segment longer than every edge of the model corresponds to none.
TEST(CorrespondenceFinding, TooLongLinesMatchNothing) {
  const TestModel book = testing::Load("book"), refrigerator = testing::Load("refrigerator");
  Random random(4);
  const auto matching = std::make_unique<Matching>();
  Pose T;
  T.R = ExpSo3({0.4, 0.5, 0.1}) * (Matrix3d() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished();
  T.t = {0, 0, 3};
  const auto scene = testing::MakeScene(random, *refrigerator, T, {.min_cover = 0.98, .clutter = 0});
  Match(*book, *scene, *matching);
  for (const CorrespondingPair& c : matching->pairs.items()) {
    const ImageLinePair& pair = matching->sets.pairs[c.image_pair];
    EXPECT_LT(scene->lines[pair.base].Length(), 1.5F * book->edges[c.base_edge].length_m);
  }
  Match(*refrigerator, *scene, *matching);
  EXPECT_GT(matching->pairs.items().size(), 100U);
}

TEST(HypothesisMaking, NothingFromNothing) {
  const TestModel model = testing::Load("parcel_box");
  const auto scene = std::make_unique<IdealScene>();
  const auto matching = std::make_unique<Matching>();
  Match(*model, *scene, *matching);
  EXPECT_EQ(matching->pairs.items().size(), 0U);
  EXPECT_EQ(matching->hypotheses.size(), 0U);
}

// Two parallel lines alone: each may be either edge of each pair of equal length and distance, and
// may run either way. The oracle solves every assignment and keeps those whose edges can be seen.
TEST(HypothesisMaking, ParallelPairGivesEveryAssignment) {
  const TestModel model = testing::Compile(testing::TwoPartMesh());
  ASSERT_EQ(model->symmetries.size(), 1U);
  const auto scene = std::make_unique<IdealScene>();
  // Everything in the image supports everything: only geometry decides.
  for (EdgeMap* map : {&scene->left, &scene->right}) {
    map->width = 640;
    map->height = 480;
    map->directions.fill(0xFFFF);
    map->background = 0.5F;
  }
  Pose T;
  T.R = ExpSo3({-2.2, 0.3, 0.2});
  T.t = {0, 0, 0.9};
  const Vector3d ends[2][2] = {{T * Vector3d(-0.15, -0.1, 0.02), T * Vector3d(0.15, -0.1, 0.02)},
                               {T * Vector3d(-0.15, 0.1, 0.02), T * Vector3d(0.15, 0.1, 0.02)}};
  for (const auto& [a, b] : ends) {
    Line3 line;
    line.id = static_cast<std::uint16_t>(scene->lines.size());
    line.has_depth = true;
    line.a = a.cast<float>();
    line.b = b.cast<float>();
    const Vector3d pa = scene->camera.Project(a), pb = scene->camera.Project(b);
    line.segment.a = pa.head<2>().cast<float>();
    line.segment.b = pb.head<2>().cast<float>();
    line.disparity_a_px = static_cast<float>(pa.z());
    line.disparity_b_px = static_cast<float>(pb.z());
    line.var_a = line.var_b = 0.01F;
    line.segment.sigma_angle_rad = 0.002F;
    scene->lines.push_back(line);
  }
  const auto matching = std::make_unique<Matching>();
  Match(*model, *scene, *matching);

  int expected = 0;
  const Vector3d d1 = (ends[0][1] - ends[0][0]).normalized();
  const Vector3d across = 0.5 * (ends[1][0] + ends[1][1] - ends[0][0] - ends[0][1]);
  for (std::size_t e = 0; e < model->edges.size(); ++e) {
    for (std::size_t f = 0; f < model->edges.size(); ++f) {
      const PreparedEdge &p = model->edges[e], &q = model->edges[f];
      const Vector3d pm = 0.5 * (p.a + p.b).cast<double>(), qm = 0.5 * (q.a + q.b).cast<double>();
      if (e == f || std::abs(p.length_m - 0.3F) > 1e-4F || std::abs(q.length_m - 0.3F) > 1e-4F ||
          std::abs((qm - pm).norm() - 0.2) > 1e-4)
        continue;
      for (const double sign : {1.0, -1.0}) {
        const Vector3d m1 = sign * p.direction.cast<double>();
        Matrix3d M, D;
        M << m1, (qm - pm).normalized(), m1.cross((qm - pm).normalized());
        D << d1, across.normalized(), d1.cross(across.normalized());
        Pose candidate{D * M.transpose(), {}};
        candidate.t = 0.5 * (ends[0][0] + ends[0][1]) - candidate.R * pm;
        const Vector3d eye = candidate.Inverse().t;
        if (!testing::SeesEdgePoint(*model, e, 0.5, eye) || !testing::SeesEdgePoint(*model, f, 0.5, eye)) continue;
        ++expected;
        EXPECT_LT(NearestError(*model, matching->hypotheses, candidate), 0.02) << e << " " << f << " " << sign;
      }
    }
  }
  EXPECT_GE(expected, 3);  // four, less what the upper part hides
}

}  // namespace
}  // namespace wirepose
