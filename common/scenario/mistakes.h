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
  std::string text;      ///< The value and what is allowed.
  FieldPath other = {};  ///< Where two fields contradict each other, and only this one may be given.
  int element = 0;       ///< Which one, where a field on the path is repeated.
};

/// Values that are not allowed, by the option of that name in scenario.proto, and fields that contradict each
/// other. Whether the world file exists is not asked. A field that is absent contradicts nothing, unless its
/// default is known here (see models.h).
std::vector<Mistake> MistakesIn(const Scenario& scenario);

/// Blocks of services that no source names: what is switched on is stated, never inferred from a block that
/// is there. Of a scenario as it was given; once defaults are filled in, every block is there.
std::vector<Mistake> UnusedBlocksIn(const Scenario& given);

/// The mapper's window about the sensor (ScanMarks::kMaxReach) reaches no further; a test compares.
inline constexpr int kMostVoxelsOfRange = 399;
/// The explorer counts in 16 bits how many voxels within the clearance block a voxel; 24 would just do.
inline constexpr int kMostVoxelsOfClearance = 20;

/// What a value of the field looks like: "a number", "true or false", "one of Z, Y".
std::string TypeText(const google::protobuf::FieldDescriptor* field);
/// What a number or name may be: "in (0, 10] m", "one of closest, potential".
std::string AllowedText(const FieldPath& path);

/// What is wrong with a name that is none of those: 'is "clsest", must be one of closest, flow; did you mean
/// closest?'
std::string NotOneOf(const std::vector<std::string>& names, const std::string& name);

/// Whether `value` is in an interval such as "(0, 10]". NaN never is.
bool IsInInterval(double value, const std::string& interval);

}  // namespace thalweg
