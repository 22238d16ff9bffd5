#pragma once

#include <array>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

/// Real images: those of the folder THALWEG_DATA, if there is one.
namespace thalweg::stereo::test {

inline std::optional<std::filesystem::path> DataFolder(const std::string& name) {
  const char* const data = std::getenv("THALWEG_DATA");
  if (data == nullptr) return std::nullopt;
  const std::filesystem::path folder = std::filesystem::path(data) / name;
  if (!std::filesystem::is_directory(folder)) return std::nullopt;
  return folder;
}

/// A pair of Middlebury's.
struct Scene {
  std::string name;
  double scale;
  int max_disparity;
};
inline const std::array<Scene, 4> kClassics = {
    {{"tsukuba", 16, 16}, {"venus", 8, 32}, {"teddy", 4, 64}, {"cones", 4, 64}}};

}  // namespace thalweg::stereo::test
