#pragma once

#include <array>
#include <string_view>

namespace thalweg::cli {

// Names of the services of a run: NAME of thalweg-NAME, by which --without, logs and health call it.

inline constexpr auto kMapper = "mapper";  ///< Its end leaves files.
inline constexpr auto kExplorer = "explorer";
inline constexpr auto kController = "controller";
inline constexpr auto kSurface = "surface";  ///< Optional; its end leaves files.
inline constexpr auto kStereo = "stereo";
inline constexpr auto kVisualOdometry = "visual-odometry";
inline constexpr auto kSimulator = "simulator";  ///< Stands in for a robot.

inline constexpr std::array<std::string_view, 7> kServices = {kMapper, kExplorer,       kController, kSurface,
                                                              kStereo, kVisualOdometry, kSimulator};

}  // namespace thalweg::cli
