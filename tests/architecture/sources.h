#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/places.h"

namespace thalweg::test {

inline const std::filesystem::path kRoot = SourceFolder();  ///< Root of the repository.

/// A C++ file of the repository, split into lines, with comments removed.
struct Source {
  std::string path;  ///< Relative to the repository's root, e.g. services/mapper/core/occupancy_map.cpp.
  std::vector<std::string> lines;

  std::string At(std::size_t line) const { return path + ':' + std::to_string(line + 1); }
  /// The text between the quotes or brackets of an #include line; empty for other lines.
  static std::string IncludeIn(const std::string& line);
};

/// All .h and .cpp files under a folder of the repository.
std::vector<Source> SourcesUnder(const std::string& folder);

/// services/mapper/core/x.h -> mapper, core; empty if there is none.
std::string ServiceOf(const std::string& path);
std::string LayerOf(const std::string& path);

}  // namespace thalweg::test
