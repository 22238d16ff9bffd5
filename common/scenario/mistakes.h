#pragma once

#include <string>
#include <vector>

#include "scenario.pb.h"

namespace thalweg {

/// A field from the scenario inwards.
using FieldPath = std::vector<const google::protobuf::FieldDescriptor*>;
std::string ToString(const FieldPath& path);  ///< "mapper.voxel_size_m"

struct Mistake {
  FieldPath field;
  std::string text;  ///< The value and what is allowed.
};

/// Values that are not allowed, by the option of that name in scenario.proto, and fields that contradict each
/// other. Whether the world file exists is not asked.
std::vector<Mistake> MistakesIn(const Scenario& scenario);

/// Whether `value` is in an interval such as "(0, 10]". NaN never is.
bool IsInInterval(double value, const std::string& interval);

}  // namespace thalweg
