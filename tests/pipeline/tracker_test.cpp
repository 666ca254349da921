// Tracks over simulated motion: ids stay, nothing flips, and what is uncommon does no harm.
#include "pipeline/tracker.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "track_world.h"

namespace wirepose {
namespace {

using testing::Noise;
using testing::TrackWorld;

constexpr double kRate = 30;

struct Mover {
  std::uint32_t model_id;
  Pose start;
  Vector3d velocity, rate;

  [[nodiscard]] Pose At(double t) const { return {ExpSo3(t * rate) * start.R, start.t + t * velocity}; }
};

double AngleBetween(const Pose& p, const Pose& q) { return LogSo3(p.R * q.R.transpose()).norm(); }

Pose AnyPose(TrackWorld& world, double x, double y, double z) { return {ExpSo3(world.AnyVector(1)), {x, y, z}}; }

// One detection a frame at the given pose.
RecognitionResult Frame(std::initializer_list<Detection> detections) {
  RecognitionResult result;
  for (const Detection& d : detections) result.detections.push_back(d);
  return result;
}

// Four objects that move and turn, one in seven missed, a false alarm in five frames: over ten seconds every object
// keeps its id and its orientation.
TEST(Tracker, IdsStayOverHundredsOfFrames) {
  int changes = 0, flips = 0, frames_with_id = 0, published = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    TrackWorld world(seed);
    Tracker tracker;
    Noise noise;
    noise.false_alarms = 0.2;
    std::vector<Mover> movers;
    for (int i = 0; i < 4; ++i) {
      const double x = -0.6 + 0.4 * i;
      movers.push_back({i % 2 == 0 ? 1U : 2U, AnyPose(world, x, world.Uniform(-0.3, 0.3), world.Uniform(1.2, 1.8)),
                        world.AnyVector(0.015), world.AnyVector(0.05)});
    }
    std::map<std::size_t, std::uint32_t> id_of;
    std::map<std::size_t, Pose> last;
    for (int f = 0; f < 300; ++f) {
      const double t = f / kRate;
      RecognitionResult result;
      std::vector<std::size_t> who;
      for (std::size_t i = 0; i < movers.size(); ++i) {
        if (world.Uniform(0, 1) < noise.misses) continue;
        result.detections.push_back(world.Measure(movers[i].model_id, movers[i].At(t), noise));
        who.push_back(i);
      }
      if (world.Uniform(0, 1) < noise.false_alarms) result.detections.push_back(world.FalseAlarm());
      tracker.Update(TrackWorld::Time(t), world.scene, result);
      published += static_cast<int>(result.detections.size());
      std::set<std::uint32_t> ids;
      for (std::size_t k = 0; k < who.size(); ++k) {
        const Detection& d = result.detections[k];
        ids.insert(d.track_id);
        ++frames_with_id;
        const auto [entry, fresh] = id_of.try_emplace(who[k], d.track_id);
        changes += !fresh && entry->second != d.track_id ? 1 : 0;
        entry->second = d.track_id;
        if (last.contains(who[k])) flips += AngleBetween(last[who[k]], d.T_camera_model) > 0.3 ? 1 : 0;
        last[who[k]] = d.T_camera_model;
      }
      EXPECT_EQ(ids.size(), who.size()) << "two objects under one id";
      EXPECT_FALSE(ids.contains(0));
    }
    for (const auto& [i, id] : id_of) {
      const auto tracks = tracker.tracks();
      const auto* const track =
          std::find_if(tracks.data(), tracks.data() + tracks.size(), [id = id](const Track& x) { return x.id == id; });
      ASSERT_NE(track, tracks.data() + tracks.size());
      EXPECT_GT(track->existence(), 0.9F);
    }
  }
  printf("%d detections of objects in 6000 frames, %d changes of id, %d flips\n", frames_with_id, changes, flips);
  EXPECT_EQ(changes, 0);
  EXPECT_EQ(flips, 0);
  EXPECT_GT(published, frames_with_id) << "false alarms belong to the test";
}

// Two equal boxes pass each other; while one hides the other only the front one is seen.
TEST(Tracker, EqualObjectsThatCrossKeepTheirIds) {
  int swaps = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    TrackWorld world(seed);
    Tracker tracker;
    const Noise noise;
    const Matrix3d R = ExpSo3(world.AnyVector(1));
    const Mover front{1, {R, {-0.45, 0, 1.2}}, {0.3, 0, 0}, Vector3d::Zero()};
    const Mover back{1, {R, {0.45, 0.02, 1.7}}, {-0.3, 0, 0}, Vector3d::Zero()};
    std::uint32_t front_id = 0, back_id = 0, last_front = 0, last_back = 0;
    for (int f = 0; f < 90; ++f) {
      const double t = f / kRate;
      const double apart = std::abs(front.At(t).t.x() / 1.2 - back.At(t).t.x() / 1.7);
      const bool hidden = apart < 0.1;
      RecognitionResult result;
      const bool front_found = world.Uniform(0, 1) > noise.misses;
      const bool back_found = !hidden && world.Uniform(0, 1) > noise.misses;
      if (back_found) result.detections.push_back(world.Measure(1, back.At(t), noise));
      if (front_found) result.detections.push_back(world.Measure(1, front.At(t), noise));
      tracker.Update(TrackWorld::Time(t), world.scene, result);
      if (back_found) last_back = result.detections[0].track_id;
      if (front_found) last_front = result.detections.back().track_id;
      if (f == 10) {
        front_id = last_front;
        back_id = last_back;
      }
    }
    swaps += last_front == front_id && last_back == back_id ? 0 : 1;
  }
  printf("%d of 40 crossings end with other ids\n", swaps);
  EXPECT_EQ(swaps, 0);
}

// A recognizer that cannot tell two poses apart, and finds now this and now that one heavier.
TEST(Tracker, ModesDoNotFlip) {
  TrackWorld world(7);
  Tracker tracker;
  const Pose T = AnyPose(world, 0, 0, 1.5);
  const Pose turn{BoxTurn(3), Vector3d::Zero()};
  std::optional<Pose> last;
  for (int f = 0; f < 200; ++f) {
    Detection d = world.Measure(2, T, {});
    const auto weight = static_cast<float>(world.Uniform(0.3, 0.7));
    d.modes.push_back({d.T_camera_model, weight});
    d.modes.push_back({d.T_camera_model * turn, 1 - weight});
    if (weight < 0.5F) {
      std::swap(d.modes[0], d.modes[1]);
      d.T_camera_model = d.modes[0].T_camera_model;
    }
    RecognitionResult result = Frame({d});
    tracker.Update(TrackWorld::Time(f / kRate), world.scene, result);
    const Detection& out = result.detections[0];
    ASSERT_EQ(out.modes.size(), 2U);
    EXPECT_NEAR(out.modes[0].weight + out.modes[1].weight, 1, 1e-5);
    EXPECT_GE(out.modes[0].weight, out.modes[1].weight);
    EXPECT_EQ(out.T_camera_model.R, out.modes[0].T_camera_model.R);
    if (last) {
      EXPECT_LT(AngleBetween(*last, out.T_camera_model), 0.1) << "frame " << f;
    }
    last = out.T_camera_model;
  }
}

// But what the frames say for certain is not overruled: one id, another orientation.
TEST(Tracker, CertainFramesTurnTheTrack) {
  TrackWorld world(8);
  Tracker tracker;
  const Pose T = AnyPose(world, 0, 0, 1.5);
  Noise turned;
  turned.turns = 1;
  RecognitionResult result;
  std::uint32_t id = 0;
  for (int f = 0; f < 20; ++f) {
    result = Frame({world.Measure(2, T, f < 10 ? Noise{} : turned)});
    tracker.Update(TrackWorld::Time(f / kRate), world.scene, result);
    if (f == 0) id = result.detections[0].track_id;
    EXPECT_EQ(result.detections[0].track_id, id);
  }
  EXPECT_LT(AngleBetween(result.detections[0].T_camera_model, T * Pose{BoxTurn(3), Vector3d::Zero()}), 0.05);
  EXPECT_EQ(tracker.statistics().turned, 1U);
}

// Scores and covariances are the frame's own, and a prior is no detection.
TEST(Tracker, ReportsOnlyWhatTheFrameShows) {
  TrackWorld world(9);
  Tracker tracker;
  RecognitionResult result = Frame({world.Measure(1, AnyPose(world, 0, 0, 1.5), {})});
  const RecognitionResult before = result;
  tracker.Update(TrackWorld::Time(0), world.scene, result);
  EXPECT_EQ(result.detections[0].score, before.detections[0].score);
  EXPECT_FLOAT_EQ(result.detections[0].existence, before.detections[0].score);
  result = {};
  tracker.Update(TrackWorld::Time(0.03), world.scene, result);
  EXPECT_TRUE(result.detections.empty());
  EXPECT_EQ(tracker.tracks().size(), 1U);
}

// An object that drives past at half a metre a second and ten frames a second is predicted well enough to be refined:
// two centimetres, and the three degrees that refinement pulls in.
TEST(Tracker, PredictsMotion) {
  TrackWorld world(10);
  Tracker tracker;
  const Mover mover{2, AnyPose(world, -0.5, 0, 1.8), {0.3, 0.02, -0.4}, {0, 0.1, 0}};
  PosePriors priors;
  for (int f = 0; f < 20; ++f) {
    const double t = f / 10.0;
    tracker.Predict(TrackWorld::Time(t), world.scene, priors);
    if (f > 4) {
      ASSERT_EQ(priors.size(), 1U);
      EXPECT_LT((priors[0].T_camera_model.t - mover.At(t).t).norm(), 0.02);
      EXPECT_LT(AngleBetween(priors[0].T_camera_model, mover.At(t)), 0.05);
    }
    RecognitionResult result = Frame({world.Measure(2, mover.At(t), {})});
    tracker.Update(TrackWorld::Time(t), world.scene, result);
  }
}

class OneTrack : public ::testing::Test {
 protected:
  OneTrack() : pose_(AnyPose(world_, 0, 0, 1.5)) {
    for (int f = 0; f < 30; ++f) id_ = Show(f / kRate);
  }
  // Shows the object and returns its id.
  std::uint32_t Show(double t) {
    RecognitionResult result = Frame({world_.Measure(1, pose_, {})});
    tracker_.Update(TrackWorld::Time(t), world_.scene, result);
    return result.detections[0].track_id;
  }
  void ShowNothing(double t) {
    RecognitionResult result;
    tracker_.Update(TrackWorld::Time(t), world_.scene, result);
  }

  TrackWorld world_{11};
  Tracker tracker_;
  Pose pose_;
  std::uint32_t id_ = 0;
};

TEST_F(OneTrack, EndsWhenItIsNoLongerSeen) {
  float last = tracker_.tracks()[0].existence();
  int frames = 0;
  while (!tracker_.tracks().empty() && frames < 100) {
    ShowNothing(1 + ++frames / kRate);
    if (tracker_.tracks().empty()) break;
    EXPECT_LT(tracker_.tracks()[0].existence(), last);
    last = tracker_.tracks()[0].existence();
  }
  printf("a certain object ends after %d misses\n", frames);
  EXPECT_GT(frames, 4);
  EXPECT_LT(frames, 45);
}

// What cannot be seen is not missed: outside the region, or of a model that is not searched for.
TEST_F(OneTrack, IsNotMissedWhereNobodyLooks) {
  const float before = tracker_.tracks()[0].existence();
  PosePriors priors;
  world_.scene.region = {0, 0, 64, 64};
  for (int f = 0; f < 30; ++f) ShowNothing(1 + f / kRate);
  tracker_.Predict(TrackWorld::Time(2.01), world_.scene, priors);
  EXPECT_TRUE(priors.empty());
  world_.scene.region = {};
  world_.scene.searched = 2;
  for (int f = 0; f < 30; ++f) ShowNothing(2 + f / kRate);
  tracker_.Predict(TrackWorld::Time(3.01), world_.scene, priors);
  EXPECT_TRUE(priors.empty());
  ASSERT_EQ(tracker_.tracks().size(), 1U);
  EXPECT_EQ(tracker_.tracks()[0].existence(), before);
  world_.scene.searched = 3;
  EXPECT_EQ(Show(3.1), id_);
}

TEST_F(OneTrack, ALateFrameIsLabelledAndTeachesNothing) {
  const Track before = tracker_.tracks()[0];
  const CaptureTime late = TrackWorld::Time(0.9);
  PosePriors priors;
  tracker_.Predict(late, world_.scene, priors);
  EXPECT_TRUE(priors.empty());
  EXPECT_EQ(Show(0.9), id_);
  EXPECT_EQ(tracker_.tracks()[0].motion.T.t, before.motion.T.t);
  EXPECT_EQ(tracker_.tracks()[0].log_odds, before.log_odds);
  EXPECT_EQ(tracker_.statistics().late, 1U);
  EXPECT_EQ(Show(1.0), id_);
}

TEST_F(OneTrack, SurvivesAGapAndEndsWithALongOne) {
  EXPECT_EQ(Show(2.5), id_);
  EXPECT_NE(Show(6.0), id_);
  EXPECT_EQ(tracker_.statistics().restarts, 1U);
  EXPECT_EQ(tracker_.tracks().size(), 1U);
}

// A camera that comes back with another time base.
TEST_F(OneTrack, AClockThatStepsBackForgetsAll) {
  const std::uint32_t fresh = Show(-100);
  EXPECT_NE(fresh, id_);
  EXPECT_EQ(Show(-100 + 1 / kRate), fresh);
  EXPECT_EQ(tracker_.statistics().restarts, 1U);
}

TEST_F(OneTrack, AReloadedModelIsAnotherOne) {
  world_.model(1).view.checksum = 5;
  PosePriors priors;
  tracker_.Predict(TrackWorld::Time(1.01), world_.scene, priors);
  EXPECT_TRUE(priors.empty());
  const std::uint32_t fresh = Show(1.01);
  EXPECT_NE(fresh, id_);
  tracker_.Forget();
  EXPECT_NE(Show(1.02), fresh);
}

TEST_F(OneTrack, NothingIsKnownOfAModelThatIsGone) {
  world_.scene.models = world_.scene.models.subspan(1);
  RecognitionResult result;
  Detection stranger;
  stranger.model_id = 1;
  result.detections.push_back(stranger);
  tracker_.Update(TrackWorld::Time(1.01), world_.scene, result);
  EXPECT_EQ(result.detections[0].track_id, 0U);
  EXPECT_TRUE(tracker_.tracks().empty());
}

// Five times as many objects as the table holds, one after the other: the least probable give way, and are counted.
TEST(Tracker, AFullTableKeepsTheMostProbable) {
  TrackWorld world(12);
  Tracker tracker;
  const Pose sure = AnyPose(world, 0, 0, 1);
  std::uint32_t id = 0;
  for (int f = 0; f < 12; ++f) {
    RecognitionResult result = Frame({world.Measure(2, sure, {})});
    // Ids of the crowd differ: it stands elsewhere each time, outside the image, where it is not missed.
    for (int i = 1; i < static_cast<int>(kMaxDetections); ++i) {
      Detection d = world.Measure(1, AnyPose(world, 3.0 * i, 3.0 + f, 2), {});
      d.score = 0.6F;
      result.detections.push_back(d);
    }
    tracker.Update(TrackWorld::Time(f / kRate), world.scene, result);
    if (f == 0) id = result.detections[0].track_id;
    EXPECT_EQ(result.detections[0].track_id, id);
    EXPECT_LE(tracker.tracks().size(), kMaxTracks);
  }
  EXPECT_EQ(tracker.tracks().size(), kMaxTracks);
  EXPECT_GE(tracker.statistics().dropped, 12U * 15 - kMaxTracks);
  EXPECT_GT(tracker.tracks()[0].existence(), 0);
}

TEST(Tracker, SameCallsSameBytes) {
  const auto run = [] {
    TrackWorld world(13);
    Tracker tracker;
    std::vector<double> numbers;
    for (int f = 0; f < 50; ++f) {
      RecognitionResult result = Frame(
          {world.Measure(1, {Matrix3d::Identity(), {0.01 * f, 0, 1.5}}, {}), world.FalseAlarm(), world.FalseAlarm()});
      tracker.Update(TrackWorld::Time(f / kRate), world.scene, result);
      for (const Track& track : tracker.tracks()) {
        numbers.push_back(track.id);
        numbers.push_back(static_cast<double>(track.log_odds));
        numbers.push_back(track.motion.T.t.x());
      }
    }
    return numbers;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace wirepose
