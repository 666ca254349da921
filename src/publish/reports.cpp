#include "publish/reports.h"

#include <algorithm>

namespace wirepose {

ModelLabels LabelsOf(std::span<const ModelView> models, std::uint32_t searched) {
  ModelLabels labels;
  for (std::size_t i = 0; i < std::min(models.size(), kMaxModels); ++i) {
    const ModelView& model = models[i];
    labels.push_back({model.id, model.checksum, FixedText<kMaxModelName>(model.name), model.box_min_m, model.box_max_m,
                      ((searched >> i) & 1U) != 0});
  }
  return labels;
}

}  // namespace wirepose
