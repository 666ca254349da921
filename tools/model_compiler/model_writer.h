// Puts the records of a line model into the bytes of a .wpm file.
#ifndef WIREPOSE_TOOLS_MODEL_COMPILER_MODEL_WRITER_H_
#define WIREPOSE_TOOLS_MODEL_COMPILER_MODEL_WRITER_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "model/model_format.h"

namespace wirepose::tools {

// The content of a model file as plain lists; see model_format.h for what each holds.
struct ModelRecords {
  std::uint32_t id = 0;
  std::string name;  // shorter than kMaxModelName
  float diameter_m = 0;
  std::array<float, 3> box_min_m{}, box_max_m{};
  std::vector<ModelVertex> vertices;
  std::vector<ModelTriangle> triangles;
  std::vector<ModelFace> faces;
  std::vector<ModelEdge> edges;
  std::vector<ModelLineSet> line_sets;
  std::vector<ModelSetMember> set_members;
  std::vector<ModelSymmetry> symmetries;
  std::vector<ModelAspect> aspects;
};

// The whole file, with sizes, offsets and checksum. Checks nothing: ParseModel does. O(size).
std::vector<std::byte> WriteModel(const ModelRecords& records);

// Writes size and checksum of `file` anew after its records have been edited in place (tests of the
// parser).
void SealModel(std::vector<std::byte>& file);

}  // namespace wirepose::tools

#endif  // WIREPOSE_TOOLS_MODEL_COMPILER_MODEL_WRITER_H_
