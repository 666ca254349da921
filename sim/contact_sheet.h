// Many small pictures on one: a look at a whole data set.
#ifndef WIREPOSE_SIM_CONTACT_SHEET_H_
#define WIREPOSE_SIM_CONTACT_SHEET_H_

#include <filesystem>
#include <string>

#include "base/result.h"

namespace wirepose::sim {

// Writes up to 30 left images of the data set, evenly chosen, at half their size into one PNG with
// up to 5 columns. The error is one line.
[[nodiscard]] Result<void, std::string> WriteContactSheet(const std::filesystem::path& dataset_root,
                                                          const std::filesystem::path& png);

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_CONTACT_SHEET_H_
