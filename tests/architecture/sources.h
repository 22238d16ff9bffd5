#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thalweg::test {

/// A C++ file of the repository, cut into lines, comments taken out.
struct Source {
  std::string path;  ///< From the repository's root, e.g. services/mapper/core/occupancy_map.cpp.
  std::vector<std::string> lines;

  std::string At(std::size_t line) const { return path + ':' + std::to_string(line + 1); }
  /// What stands between the quotes or brackets of an #include line; empty on any other.
  static std::string IncludeIn(const std::string& line);
};

/// All .h and .cpp files under a folder of the repository.
std::vector<Source> SourcesUnder(const std::string& folder);

/// services/mapper/core/x.h -> mapper, core; empty where there is none.
std::string ServiceOf(const std::string& path);
std::string LayerOf(const std::string& path);

}  // namespace thalweg::test
