// The recognizer as a whole: finds what is there, keeps no state between frames, refuses what it
// cannot use.
#include "pipeline/recognizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "recognizer_dump.h"
#include "tests/golden/golden_frames.h"

namespace wirepose {
namespace {

using testing::StereoImages;

Recognizer& TheRecognizer() {
  static Recognizer recognizer;
  return recognizer;
}

RecognizerError Process(const StereoImages& images, RecognitionResult& result, StageObserver* observer = nullptr) {
  return TheRecognizer().Process(images.left.view(), images.right.view(), observer, result);
}

class RecognizerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(TheRecognizer().Configure(testing::GoldenCalibration()), RecognizerError::kOk);
    TheRecognizer().ClearModels();
  }
  void AddModels() {
    for (const auto& model : models_) ASSERT_EQ(TheRecognizer().AddModel(model.View()), RecognizerError::kOk);
  }

  std::vector<tools::CompiledModel> models_ = testing::GoldenModels();
  RecognitionResult result_;
};

// Largest distance of a vertex from its true place, modulo symmetry, as a share of the diameter.
double ErrorShare(const PreparedModel& model, const Pose& estimate, const Pose& truth) {
  double best = 1e9;
  for (const Pose& symmetry : model.symmetries) {
    double worst = 0;
    for (std::size_t i = 0; i < model.view.vertices.size(); ++i) {
      const Vector3d p = model.view.VertexPosition(i).cast<double>();
      worst = std::max(worst, (estimate * p - truth * (symmetry * p)).norm());
    }
    best = std::min(best, worst);
  }
  return best / static_cast<double>(model.view.diameter_m);
}

// Freshly rendered kitchens: most well visible objects are found, nearly nothing else, and what is
// found is close.
TEST_F(RecognizerTest, FindsObjectsInRenderedKitchens) {
  AddModels();
  std::vector<std::unique_ptr<PreparedModel>> prepared;
  for (const auto& model : models_) {
    prepared.push_back(std::make_unique<PreparedModel>());
    PrepareModel(model.View(), *prepared.back());
  }
  auto targets = sim::LoadTargetMeshes(WIREPOSE_MODELS);
  ASSERT_TRUE(targets);
  targets->resize(3);
  int visible = 0, found = 0, false_alarms = 0;
  double worst = 0;
#ifdef __SANITIZE_ADDRESS__
  constexpr std::uint64_t kLast = 201;  // rendering takes ten times as long
#else
  constexpr std::uint64_t kLast = 203;
#endif
  for (std::uint64_t seed = 201; seed <= kLast; ++seed) {
    sim::ScenarioSpec spec;
    spec.seed = seed;
    spec.samples = 9;
    spec.camera.calibration = testing::GoldenCalibration();
    const auto video = sim::ScenarioVideo::Create(spec, 0, *targets);
    ASSERT_TRUE(video);
    const sim::StereoShot shot = video->Shoot(0);
    ASSERT_EQ(Process({shot.left, shot.right}, result_), RecognizerError::kOk);
    std::vector<bool> used(result_.detections.size());
    for (const sim::ObjectTruth& object : shot.truth.objects) {
      const PreparedModel& model = *prepared[static_cast<std::size_t>(object.obj_id - 1)];
      bool hit = false;
      for (std::size_t i = 0; i < used.size() && !hit; ++i) {
        const Detection& d = result_.detections[i];
        if (used[i] || static_cast<int>(d.model_id) != object.obj_id) continue;
        const double error = ErrorShare(model, d.T_camera_model, object.T_camera_object);
        if (error > 0.1) continue;
        used[i] = hit = true;
        worst = std::max(worst, error);
        const Eigen::LDLT<Matrix6d> ldlt(d.covariance);
        EXPECT_GT(ldlt.vectorD().minCoeff(), 0);
      }
      if (object.visib_fract < 0.6) continue;
      ++visible;
      found += hit ? 1 : 0;
    }
    for (const bool u : used) false_alarms += u ? 0 : 1;
  }
  printf("%d of %d visible objects found, %d false alarms, largest error %.3f of the diameter\n", found, visible,
         false_alarms, worst);
  EXPECT_GE(visible, 1);
  EXPECT_GE(2 * found, visible);
  EXPECT_LE(false_alarms, 2);
}

// Of the poses that the box's symmetries make equal the prior's is reported, with the score, the covariance and the
// line set that belong to it.
TEST_F(RecognizerTest, APriorDecidesBetweenEqualPoses) {
  AddModels();
  const StereoImages frame = testing::GoldenFrame(0);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  ASSERT_EQ(result_.detections.size(), 1U);
  const Detection alone = result_.detections[0];
  const PreparedModel& model = TheRecognizer().prepared_model(0);
  ASSERT_EQ(model.symmetries.size(), 4U);
  const auto edges = [&](const Pose& T) {
    std::vector<std::pair<int, Vector3d>> middles;
    for (const SetMember& m : TheRecognizer().line_set(0)) {
      middles.emplace_back(m.line, T * (0.5F * (model.edges[m.edge].a + model.edges[m.edge].b)).cast<double>());
    }
    return middles;
  };
  const auto expected = edges(alone.T_camera_model);
  for (const Pose& S : model.symmetries) {
    const PosePrior prior{alone.model_id, alone.T_camera_model * S};
    ASSERT_EQ(TheRecognizer().Process(frame.left.view(), frame.right.view(), {&prior, 1}, nullptr, result_),
              RecognizerError::kOk);
    ASSERT_EQ(result_.detections.size(), 1U);
    const Detection& d = result_.detections[0];
    EXPECT_LT((d.T_camera_model.R - prior.T_camera_model.R).norm(), 1e-6);
    EXPECT_LT((d.T_camera_model.t - prior.T_camera_model.t).norm(), 1e-6);
    EXPECT_EQ(d.score, alone.score);
    const auto found = edges(d.T_camera_model);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].first, expected[i].first);
      EXPECT_LT((found[i].second - expected[i].second).norm(), 1e-3);
    }
  }
}

// Priors that are wrong, of a model that is not searched for, or behind the camera change nothing.
TEST_F(RecognizerTest, WrongPriorsChangeNothing) {
  AddModels();
  const StereoImages frame = testing::GoldenFrame(0);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  const Detection alone = result_.detections[0];
  std::vector<PosePrior> priors(20);
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const double x = 0.05 * static_cast<double>(i);
    priors[i] = {static_cast<std::uint32_t>(1 + i % 5),
                 {ExpSo3({x, 2 * x, 1}), {x - 0.5, 0.3 - x, i == 7 ? -1.0 : 1.0}}};
  }
  ASSERT_EQ(TheRecognizer().Process(frame.left.view(), frame.right.view(), priors, nullptr, result_),
            RecognizerError::kOk);
  ASSERT_EQ(result_.detections.size(), 1U);
  EXPECT_EQ(result_.detections[0].score, alone.score);
  EXPECT_EQ(result_.detections[0].T_camera_model.t, alone.T_camera_model.t);
}

TEST_F(RecognizerTest, SameFrameSameBytes) {
  AddModels();
  const StereoImages frame = testing::GoldenFrame(0);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  const std::string first = testing::DumpAll(TheRecognizer(), result_);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  EXPECT_EQ(testing::DumpAll(TheRecognizer(), result_), first);
  EXPECT_GT(TheRecognizer().lines().size(), 50U);
}

TEST_F(RecognizerTest, NoStateLeaksBetweenFrames) {
  AddModels();
  const StereoImages a = testing::GoldenFrame(0), b = testing::GoldenFrame(1);
  const StereoImages black{{640, 480, std::vector<std::uint8_t>(640 * 480)},
                           {640, 480, std::vector<std::uint8_t>(640 * 480)}};
  ASSERT_EQ(Process(a, result_), RecognizerError::kOk);
  const std::string alone = testing::DumpAll(TheRecognizer(), result_);
  for (const StereoImages& between : {b, black}) {
    ASSERT_EQ(Process(between, result_), RecognizerError::kOk);
    EXPECT_NE(testing::DumpAll(TheRecognizer(), result_), alone);
    ASSERT_EQ(Process(a, result_), RecognizerError::kOk);
    EXPECT_EQ(testing::DumpAll(TheRecognizer(), result_), alone);
  }
  // Nor from an earlier calibration or other models.
  StereoCalibration other = testing::GoldenCalibration();
  other.left.fx = 400;
  ASSERT_EQ(TheRecognizer().Configure(other), RecognizerError::kOk);
  ASSERT_EQ(Process(b, result_), RecognizerError::kOk);
  TheRecognizer().ClearModels();
  ASSERT_EQ(TheRecognizer().Configure(testing::GoldenCalibration()), RecognizerError::kOk);
  AddModels();
  ASSERT_EQ(Process(a, result_), RecognizerError::kOk);
  EXPECT_EQ(testing::DumpAll(TheRecognizer(), result_), alone);
}

// A model that is left out is as if it had never been added; searching for it again restores the same bytes.
TEST_F(RecognizerTest, OnlySearchedModelsAreReported) {
  AddModels();
  const StereoImages frame = testing::GoldenFrame(2);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  const std::string all = testing::DumpAll(TheRecognizer(), result_);
  ASSERT_FALSE(result_.detections.empty());
  const std::uint32_t found = result_.detections[0].model_id;
  const std::uint32_t everything = TheRecognizer().searched();
  std::uint32_t others = 0;
  for (std::size_t m = 0; m < models_.size(); ++m) {
    if (TheRecognizer().models()[m].id != found) others |= 1U << m;
  }
  TheRecognizer().SearchFor(others);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  for (const Detection& d : result_.detections) EXPECT_NE(d.model_id, found);
  TheRecognizer().SearchFor(0);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  EXPECT_TRUE(result_.detections.empty());
  TheRecognizer().SearchFor(everything);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  EXPECT_EQ(testing::DumpAll(TheRecognizer(), result_), all);
}

// The bytes of what was found and where, whatever the model's id.
std::string WithoutId(const Detection& detection) {
  const auto bytes = [](const auto& value) {
    return std::string(reinterpret_cast<const char*>(value.data()), sizeof(value[0]) * value.size());
  };
  const Pose& T = detection.T_camera_model;
  return bytes(T.R) + bytes(T.t) + bytes(detection.covariance) +
         bytes(std::array{detection.score, detection.visible_fraction});
}

// One object under 32 ids: each of them finds it alone, with the same bytes.
TEST_F(RecognizerTest, EveryBitOfASelectionFindsItsModel) {
  AddModels();
  const StereoImages frame = testing::GoldenFrame(2);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  ASSERT_FALSE(result_.detections.empty());
  ModelView view = *std::find_if(TheRecognizer().models().begin(), TheRecognizer().models().end(),
                                 [&](const ModelView& m) { return m.id == result_.detections[0].model_id; });
  TheRecognizer().ClearModels();
  for (view.id = 100; TheRecognizer().models().size() < kMaxModels; ++view.id) {
    ASSERT_EQ(TheRecognizer().AddModel(view), RecognizerError::kOk);
  }
  std::string first;
  for (std::uint32_t m = 0; m < kMaxModels; ++m) {
    TheRecognizer().SearchFor(1U << m);
    ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
    ASSERT_FALSE(result_.detections.empty()) << m;
    for (const Detection& d : result_.detections) EXPECT_EQ(d.model_id, 100 + m);
    if (m == 0) first = WithoutId(result_.detections[0]);
    EXPECT_EQ(WithoutId(result_.detections[0]), first) << m;
  }
}

// The same with all 32 searched for, when the others have no line sets and so find nothing.
TEST_F(RecognizerTest, TheLastOfManyModelsIsFoundAsTheOnlyOne) {
  const StereoImages frame = testing::GoldenFrame(2);
  std::size_t found = 0;
  for (const auto& model : models_) {
    TheRecognizer().ClearModels();
    ASSERT_EQ(TheRecognizer().AddModel(model.View()), RecognizerError::kOk);
    ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
    const FixedVector<Detection, kMaxDetections> alone = result_.detections;
    found += alone.size();
    TheRecognizer().ClearModels();
    ModelView empty = model.View();
    empty.line_sets = {};
    for (empty.id = 100; TheRecognizer().models().size() < kMaxModels - 1; ++empty.id) {
      ASSERT_EQ(TheRecognizer().AddModel(empty), RecognizerError::kOk);
    }
    ASSERT_EQ(TheRecognizer().AddModel(model.View()), RecognizerError::kOk);
    ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
    ASSERT_EQ(result_.detections.size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_EQ(result_.detections[i].model_id, model.View().id);
      EXPECT_EQ(WithoutId(result_.detections[i]), WithoutId(alone[i]));
    }
  }
  EXPECT_GT(found, 0u);
}

TEST_F(RecognizerTest, RegionKeepsOnlyItsLines) {
  AddModels();
  const StereoImages frame = testing::GoldenFrame(2);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  const std::string whole = testing::DumpAll(TheRecognizer(), result_);
  const std::size_t all_lines = TheRecognizer().lines().size();
  std::size_t lines_in_halves = 0;
  for (const ImageRegion& half : {ImageRegion{0, 0, 320, 480}, ImageRegion{320, 0, 320, 480}}) {
    TheRecognizer().SetRegion(half);
    ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
    lines_in_halves += TheRecognizer().lines().size();
    for (const Line3& line : TheRecognizer().lines()) {
      const float x = line.segment.Middle().x();  // rectified; the golden rig's raw pixels are within 30 px of it
      EXPECT_TRUE(half.x == 0 ? x < 350 : x > 290) << x;
    }
  }
  EXPECT_EQ(lines_in_halves, all_lines) << "every line lies in one half";
  TheRecognizer().SetRegion({0, 0, 640, 480});
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  const std::string as_region = testing::DumpAll(TheRecognizer(), result_);
  TheRecognizer().SetRegion({});
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  EXPECT_EQ(testing::DumpAll(TheRecognizer(), result_), whole);
  EXPECT_EQ(as_region, whole);
}

// The image planes are the caller's: a view with another stride gives the same bytes.
TEST_F(RecognizerTest, StrideDoesNotMatter) {
  AddModels();
  const StereoImages frame = testing::GoldenFrame(1);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  const std::string expected = testing::DumpAll(TheRecognizer(), result_);
  std::vector<std::uint8_t> left(700 * 480, 13), right(700 * 480, 14);
  for (int y = 0; y < 480; ++y) {
    std::copy_n(frame.left.view().row(y), 640, left.data() + y * 700);
    std::copy_n(frame.right.view().row(y), 640, right.data() + y * 700);
  }
  ASSERT_EQ(TheRecognizer().Process({left.data(), 640, 480, 700}, {right.data(), 640, 480, 700}, nullptr, result_),
            RecognizerError::kOk);
  EXPECT_EQ(testing::DumpAll(TheRecognizer(), result_), expected);
}

TEST_F(RecognizerTest, EmptyScenesGiveEmptyResults) {
  AddModels();
  for (const std::uint8_t level : {0, 128, 255}) {
    const dataset::GrayImage flat{640, 480, std::vector<std::uint8_t>(640 * 480, level)};
    ASSERT_EQ(Process({flat, flat}, result_), RecognizerError::kOk);
    EXPECT_TRUE(result_.detections.empty());
    EXPECT_TRUE(TheRecognizer().lines().empty());
  }
  // Without models there are features but no objects.
  TheRecognizer().ClearModels();
  ASSERT_EQ(Process(testing::GoldenFrame(0), result_), RecognizerError::kOk);
  EXPECT_TRUE(result_.detections.empty());
  EXPECT_FALSE(TheRecognizer().lines().empty());
}

TEST_F(RecognizerTest, StatisticsDescribeTheFrame) {
  AddModels();
  ASSERT_EQ(Process(testing::GoldenFrame(2), result_), RecognizerError::kOk);
  const RecognitionStatistics& s = result_.statistics;
  EXPECT_EQ(s.left_segments.used, TheRecognizer().left_segments().size());
  EXPECT_EQ(s.lines.used, TheRecognizer().lines().size());
  EXPECT_EQ(s.detections.used, result_.detections.size());
  for (const RecognitionList& list : kRecognitionLists) {
    const ListUse& use = s.*list.use;
    EXPECT_GT(use.capacity, 0U);
    EXPECT_LE(use.used, use.capacity);
  }
  for (std::size_t i = 0; i < result_.detections.size(); ++i) {
    const Detection& d = result_.detections[i];
    EXPECT_TRUE(d.score >= 0 && d.score <= 1);
    EXPECT_TRUE(d.visible_fraction >= 0 && d.visible_fraction <= 1.001F);
    EXPECT_LE(d.score, result_.detections[i == 0 ? 0 : i - 1].score);
    for (const SetMember& m : TheRecognizer().line_set(i)) EXPECT_LT(m.line, TheRecognizer().lines().size());
  }
}

// The evidence of a candidate is that of the pose it ends at, and it ends with all the samples it can have.
TEST_F(RecognizerTest, CandidatesAreAdjustedToTheEndAndJudgedThere) {
  AddModels();
  std::array<std::size_t, 2> samples{}, candidates{};
  for (const std::size_t run : {0, 1}) {
    RecognizerParams params;
    if (run == 0) params.polish = params.refine;
    ASSERT_EQ(TheRecognizer().Configure(testing::GoldenCalibration(), params), RecognizerError::kOk);
    for (int frame = 0; frame < testing::kGoldenFrames; ++frame) {
      ASSERT_EQ(Process(testing::GoldenFrame(frame), result_), RecognizerError::kOk);
      for (const Candidate& candidate : TheRecognizer().candidates()) {
        EXPECT_EQ(candidate.evidence.rms_px, candidate.pose.rms_px);
        ++candidates[run];
        samples[run] += candidate.pose.inliers;
      }
    }
    ASSERT_GT(candidates[run], 0U);
  }
  EXPECT_GT(samples[1] / candidates[1], 3 * samples[0] / candidates[0] / 2);
}

TEST_F(RecognizerTest, StagesAreObservedInOrder) {
  class Recorder final : public StageObserver {
   public:
    std::vector<Stage> stages;

   private:
    void DoStageDone(Stage stage) override { stages.push_back(stage); }
  };
  AddModels();
  Recorder recorder;
  ASSERT_EQ(Process(testing::GoldenFrame(0), result_, &recorder), RecognizerError::kOk);
  ASSERT_GE(recorder.stages.size(), kStageCount);
  EXPECT_EQ(recorder.stages.front(), Stage::kRectify);
  EXPECT_EQ(recorder.stages[1], Stage::kSegments);
  EXPECT_EQ(recorder.stages.back(), Stage::kSelect);
  EXPECT_EQ(std::set<Stage>(recorder.stages.begin(), recorder.stages.end()).size(), kStageCount);
  std::set<std::string> names;
  for (std::size_t i = 0; i < kStageCount; ++i) names.insert(StageName(static_cast<Stage>(i)));
  EXPECT_EQ(names.size(), kStageCount);
}

TEST_F(RecognizerTest, RefusesImagesOfAnotherSize) {
  AddModels();
  const StereoImages frame = testing::GoldenFrame(0);
  const ImageView good = frame.left.view();
  ImageView narrow = good, low = good, none = good;
  narrow.width = 639;
  low.height = 479;
  none.data = nullptr;
  for (const ImageView& bad : {narrow, low, none}) {
    EXPECT_EQ(TheRecognizer().Process(bad, good, nullptr, result_), RecognizerError::kImageSizeMismatch);
    EXPECT_EQ(TheRecognizer().Process(good, bad, nullptr, result_), RecognizerError::kImageSizeMismatch);
    EXPECT_TRUE(result_.detections.empty());
  }
}

// The left images of rendered kitchens with exact depth instead of the right ones.
TEST_F(RecognizerTest, FindsObjectsByDepth) {
  AddModels();
  auto targets = sim::LoadTargetMeshes(WIREPOSE_MODELS);
  ASSERT_TRUE(targets);
  targets->resize(3);
  const StereoCalibration rig = testing::GoldenCalibration();
  ASSERT_EQ(TheRecognizer().Configure(DepthCalibration{rig.left, rig.width, rig.height}), RecognizerError::kOk);
  EXPECT_FALSE(TheRecognizer().camera().has_right_image);
  sim::ScenarioSpec spec;
  spec.seed = 201;
  spec.samples = 9;
  spec.camera.calibration = rig;
  const auto video = sim::ScenarioVideo::Create(spec, 0, *targets);
  ASSERT_TRUE(video);
  const sim::StereoShot shot = video->Shoot(0);
  const dataset::DepthImage depth = sim::ToDepthImage(shot.truth);
  const DepthView view{depth.view(), static_cast<float>(dataset::kDepthScale / 1000)};
  ASSERT_EQ(TheRecognizer().ProcessDepth(shot.left.view(), view, nullptr, result_), RecognizerError::kOk);
  EXPECT_EQ(TheRecognizer().right_rectified().data, nullptr);
  int deep = 0, visible = 0, found = 0;
  for (const Line3& line : TheRecognizer().lines()) deep += line.has_depth ? 1 : 0;
  EXPECT_GT(2 * deep, static_cast<int>(TheRecognizer().lines().size()));
  for (const sim::ObjectTruth& object : shot.truth.objects) {
    if (object.visib_fract < 0.6) continue;
    ++visible;
    for (const Detection& d : result_.detections) {
      if (static_cast<int>(d.model_id) != object.obj_id) continue;
      const PreparedModel& model = TheRecognizer().prepared_model(static_cast<std::size_t>(object.obj_id - 1));
      found += ErrorShare(model, d.T_camera_model, object.T_camera_object) < 0.1 ? 1 : 0;
    }
  }
  printf("%d of %d visible objects found by depth\n", found, visible);
  EXPECT_GE(2 * found, visible);
}

// A frame with depth between two pairs changes neither; each camera refuses the other's frames.
TEST_F(RecognizerTest, CamerasDoNotMix) {
  AddModels();
  const StereoImages frame = testing::GoldenFrame(0);
  const ImageView image = frame.left.view();
  const std::vector<std::uint16_t> far(640 * 480, 900);
  const DepthView depth{{far.data(), 640, 480, 640}, 0.001F};
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  const std::string before = testing::DumpAll(TheRecognizer(), result_);
  EXPECT_EQ(TheRecognizer().ProcessDepth(image, depth, nullptr, result_), RecognizerError::kOtherCamera);

  const StereoCalibration rig = testing::GoldenCalibration();
  ASSERT_EQ(TheRecognizer().Configure(DepthCalibration{rig.left, rig.width, rig.height}), RecognizerError::kOk);
  EXPECT_EQ(Process(frame, result_), RecognizerError::kOtherCamera);
  DepthView bad = depth;
  bad.pixels.height = 479;
  EXPECT_EQ(TheRecognizer().ProcessDepth(image, bad, nullptr, result_), RecognizerError::kImageSizeMismatch);
  for (const float unit : {0.0F, -0.001F, 2.0F, std::nanf("")}) {
    bad = depth;
    bad.unit_m = unit;
    EXPECT_EQ(TheRecognizer().ProcessDepth(image, bad, nullptr, result_), RecognizerError::kBadDepthUnit);
  }
  ASSERT_EQ(TheRecognizer().ProcessDepth(image, depth, nullptr, result_), RecognizerError::kOk);
  EXPECT_FALSE(TheRecognizer().lines().empty());
  // Everything is on a wall: lines are 0.9 m away.
  for (const Line3& line : TheRecognizer().lines()) {
    if (!line.has_depth) continue;
    EXPECT_NEAR(line.a.z(), 0.9F, 0.01F);
  }

  ASSERT_EQ(TheRecognizer().Configure(rig), RecognizerError::kOk);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  EXPECT_EQ(testing::DumpAll(TheRecognizer(), result_), before);
}

TEST_F(RecognizerTest, RefusesModelsBeyondCapacityAndDuplicates) {
  ModelView view = models_[0].View();
  for (std::uint32_t id = 1; id <= kMaxModels; ++id) {
    view.id = id;
    ASSERT_EQ(TheRecognizer().AddModel(view), RecognizerError::kOk);
    ASSERT_EQ(TheRecognizer().AddModel(view), RecognizerError::kDuplicateModel);
    ASSERT_EQ(TheRecognizer().models().size(), id);
  }
  const StereoImages frame = testing::GoldenFrame(0);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  const std::string before = testing::DumpAll(TheRecognizer(), result_);
  view.id = kMaxModels + 1;
  EXPECT_EQ(TheRecognizer().AddModel(view), RecognizerError::kTooManyModels);
  EXPECT_EQ(TheRecognizer().models().size(), kMaxModels);
  EXPECT_EQ(TheRecognizer().prepared_models().size(), kMaxModels);
  EXPECT_EQ(TheRecognizer().searched(), 0xFFFFFFFFU);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  EXPECT_EQ(testing::DumpAll(TheRecognizer(), result_), before);
  TheRecognizer().ClearModels();
  EXPECT_TRUE(TheRecognizer().models().empty());
  EXPECT_EQ(TheRecognizer().AddModel(view), RecognizerError::kOk);
}

TEST_F(RecognizerTest, RefusesBadCalibrationsAndKeepsTheGoodOne) {
  AddModels();
  const StereoImages frame = testing::GoldenFrame(0);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  const std::string before = testing::DumpAll(TheRecognizer(), result_);
  for (const auto& [width, height] : {std::pair(641, 480), {640, 481}, {63, 480}, {640, 63}, {0, 0}, {-640, 480}}) {
    StereoCalibration c = testing::GoldenCalibration();
    c.width = width;
    c.height = height;
    EXPECT_EQ(TheRecognizer().Configure(c), RecognizerError::kImageTooLarge);
  }
  StereoCalibration c = testing::GoldenCalibration();
  c.T_right_left.t.setZero();
  EXPECT_EQ(TheRecognizer().Configure(c), RecognizerError::kBadCalibration);
  ASSERT_EQ(Process(frame, result_), RecognizerError::kOk);
  EXPECT_EQ(testing::DumpAll(TheRecognizer(), result_), before);
}

TEST(NewRecognizer, RefusesToProcess) {
  static Recognizer recognizer;
  static RecognitionResult result;
  const std::vector<std::uint8_t> pixels(640 * 480);
  const ImageView image{pixels.data(), 640, 480, 640};
  EXPECT_EQ(recognizer.Process(image, image, nullptr, result), RecognizerError::kNotConfigured);
}

TEST(Messages, NameEveryError) {
  std::set<std::string> texts;
  for (int e = 0; e <= static_cast<int>(RecognizerError::kBadDepthUnit); ++e) {
    const std::string text = Describe(static_cast<RecognizerError>(e));
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_NE(text, "?");
    texts.insert(text);
  }
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(RecognizerError::kBadDepthUnit) + 1);
}

TEST(Messages, TooManyModelsNamesTheLimit) {
  EXPECT_EQ(Describe(RecognizerError::kTooManyModels),
            "too many models; at most " + std::to_string(kMaxModels) + " are searched for at once");
}

// Everything is part of the object: the budget of the whole recognizer, 640 x 480 and 32 models.
TEST(Memory, IsStatic) {
  RecordProperty("bytes", std::to_string(sizeof(Recognizer)));
  printf("Recognizer: %.1f MiB\n", static_cast<double>(sizeof(Recognizer)) / (1 << 20));
  EXPECT_LE(sizeof(Recognizer), std::size_t{8} << 20);
}

}  // namespace
}  // namespace wirepose
