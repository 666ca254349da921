// Everything that a frame left behind in the recognizer, as text: to be compared, or read as a
// diff.
#ifndef WIREPOSE_TESTS_PIPELINE_RECOGNIZER_DUMP_H_
#define WIREPOSE_TESTS_PIPELINE_RECOGNIZER_DUMP_H_

#include <cstdio>
#include <string>

#include "pipeline/recognizer.h"

namespace wirepose::testing {

enum class Digits { kReadable, kAll };

class RecognizerDump {
 public:
  explicit RecognizerDump(Digits digits) : digits_(digits) {}

  std::string Segments(const char* title, std::span<const Segment2> segments) {
    Begin(title, segments.size());
    for (const Segment2& s : segments) {
      Numbers({s.a.x(), s.a.y(), s.b.x(), s.b.y(), s.contrast});
      if (digits_ == Digits::kAll) Numbers({s.sigma_offset_px, s.sigma_angle_rad});
      EndLine();
    }
    return std::move(text_);
  }

  std::string Lines(std::span<const Line3> lines) {
    Begin("lines: owner, disparities, their variances and covariance", lines.size());
    for (const Line3& line : lines) {
      if (!line.has_depth) {
        text_ += "no depth\n";
        continue;
      }
      text_ += std::to_string(static_cast<int>(line.owner));
      Numbers({line.disparity_a_px, line.disparity_b_px, line.var_a, line.var_b, line.cov_ab});
      if (digits_ == Digits::kAll) {
        for (const Vector3& p : {line.a, line.b}) Numbers({p.x(), p.y(), p.z()});
      }
      EndLine();
    }
    return std::move(text_);
  }

  std::string Detections(const Recognizer& recognizer, const RecognitionResult& result) {
    Begin("detections: model, score, visible fraction, translation, rotation by rows", result.detections.size());
    for (std::size_t i = 0; i < result.detections.size(); ++i) {
      const Detection& d = result.detections[i];
      text_ += std::to_string(d.model_id);
      Numbers({d.score, d.visible_fraction});
      Numbers({d.T_camera_model.t.x(), d.T_camera_model.t.y(), d.T_camera_model.t.z()});
      for (int r = 0; r < 3; ++r)
        Numbers({d.T_camera_model.R(r, 0), d.T_camera_model.R(r, 1), d.T_camera_model.R(r, 2)});
      if (digits_ == Digits::kAll) {
        for (int k = 0; k < 36; ++k) Number(d.covariance(k));
      }
      text_ += " set";
      for (const SetMember& m : recognizer.line_set(i)) Members(m.line, ':', m.edge);
      EndLine();
    }
    const RecognitionStatistics& s = result.statistics;
    text_ += "statistics: used/dropped";
    for (const RecognitionList& list : kRecognitionLists) Members((s.*list.use).used, '/', (s.*list.use).dropped);
    text_ += result.budget_hit ? " budget hit\n" : "\n";
    return std::move(text_);
  }

  std::string Candidates(std::span<const Candidate> candidates) {
    Begin("candidates: model, order, score, evidence, translation", candidates.size());
    for (const Candidate& c : candidates) {
      Members(c.model, ' ', c.order);
      Numbers({c.score});
      for (const float term : TermsOf(c.evidence)) Numbers({term});
      Numbers({c.pose.T_camera_model.t.x(), c.pose.T_camera_model.t.y(), c.pose.T_camera_model.t.z()});
      EndLine();
    }
    return std::move(text_);
  }

 private:
  void Begin(const char* title, std::size_t count) {
    text_ = title;
    text_ += ", ";
    text_ += std::to_string(count);
    text_ += '\n';
  }
  void Members(std::uint32_t a, char between, std::uint32_t b) {
    text_ += ' ';
    text_ += std::to_string(a);
    text_ += between;
    text_ += std::to_string(b);
  }
  void EndLine() { text_ += '\n'; }
  void Number(double x) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, digits_ == Digits::kAll ? " %.17g" : " %.4f", x);
    text_ += buffer;
  }
  template <typename T>
  void Numbers(std::initializer_list<T> numbers) {
    for (const T x : numbers) Number(static_cast<double>(x));
  }

  Digits digits_;
  std::string text_;
};

// All intermediates and results with all digits, and a checksum of the rectified images.
inline std::string DumpAll(const Recognizer& recognizer, const RecognitionResult& result) {
  std::string text;
  for (const ImageView& image : {recognizer.left_rectified(), recognizer.right_rectified()}) {
    std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) hash = (hash ^ image(x, y)) * 1099511628211ULL;
    }
    text += std::to_string(hash);
    text += '\n';
  }
  RecognizerDump dump(Digits::kAll);
  text += dump.Segments("segments", recognizer.left_segments());
  text += dump.Lines(recognizer.lines());
  text += dump.Candidates(recognizer.candidates());
  return text + dump.Detections(recognizer, result);
}

}  // namespace wirepose::testing

#endif  // WIREPOSE_TESTS_PIPELINE_RECOGNIZER_DUMP_H_
