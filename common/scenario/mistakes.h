#pragma once

#include <string>
#include <vector>

#include "common/scenario/allowed_values.h"
#include "scenario.pb.h"

namespace thalweg {

struct Mistake {
  FieldPath field;
  std::string text;  ///< The value and what is allowed.
  /// The other field if two contradict each other; only one of them may have been given.
  FieldPath other = {};
  std::vector<int> elements = {};  ///< Indices of the repeated fields on the path.
};

/// The path of a field of the scenario, or of one of its blocks, such as "mapper" and "voxel_size_m". A field
/// that does not exist is a bug of ours: it aborts.
FieldPath PathOf(const char* field);
FieldPath PathOf(const char* block, const char* field);

/// Finds values outside the range that the option `allowed` in scenario.proto states, and fields that
/// contradict each other. Does not check whether the world file exists. An absent field contradicts nothing
/// unless its default is known here (see models.h).
std::vector<Mistake> MistakesIn(const Scenario& scenario);

/// Finds blocks of services that no source uses: what is switched on is stated explicitly, never inferred
/// from the presence of a block. Takes a scenario as given, since every block is present once defaults have
/// been filled in.
std::vector<Mistake> UnusedBlocksIn(const Scenario& given);

/// Largest range of the mapper's window around the sensor (ScanMarks::kMaxReach); a test keeps the two equal.
inline constexpr int kMostVoxelsOfRange = 399;
/// The explorer counts in 16 bits how many voxels within the clearance block a voxel; 24 would just fit.
inline constexpr int kMostVoxelsOfClearance = 20;

}  // namespace thalweg
