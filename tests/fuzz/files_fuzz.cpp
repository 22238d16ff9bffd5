// libFuzzer target: any bytes as a file of each format that a user can name (scenario, world, calibration,
// list of pairs, trajectories, disparities) are read, or refused by an error that names the file.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <system_error>

#include "common/scenario/scenario.h"
#include "services/explorer/adapter/exploration_file.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/stereo/adapter/calibration_file.h"
#include "services/stereo/adapter/ground_truth.h"
#include "services/stereo/adapter/image_files.h"
#include "services/visual_odometry/adapter/trajectory_file.h"

namespace {

namespace fs = std::filesystem;
using namespace thalweg;

/// A folder in memory, removed when the program ends without a finding.
struct InputFolder {
  const fs::path path = fs::path("/dev/shm") / ("thalweg-fuzz-" + std::to_string(getpid()));
  InputFolder() { fs::create_directories(path); }
  ~InputFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

/// A file in memory, written again for each input.
const fs::path& FileWith(const std::uint8_t* data, std::size_t size, const std::string& extension) {
  static const InputFolder folder;
  static fs::path file;
  file = folder.path / ("input" + extension);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return file;
}

struct Format {
  std::string extension;
  std::function<void(const fs::path&)> read;
};
const Format kFormats[] = {
    {".txtpb", [](const fs::path& file) { LoadScenario(file.string()); }},
    {".obj", [](const fs::path& file) { simulator::LoadObj(file, simulator::UpAxis::kY, 0.01); }},
    {".yml", [](const fs::path& file) { stereo::ReadCalibration({file}); }},
    {".csv", [](const fs::path& file) { stereo::ReadPairs(file); }},
    {".txt", [](const fs::path& file) { visual_odometry::ReadKittiPoses(file); }},
    {".tum", [](const fs::path& file) { visual_odometry::ReadTumTrajectory(file); }},
    {".csv", [](const fs::path& file) { visual_odometry::ReadEurocTruth(file); }},
    {".pfm", [](const fs::path& file) { stereo::ReadScaledDisparity(file, 4.0); }},
    {".pgm", [](const fs::path& file) { stereo::ReadScaledDisparity(file, 4.0); }},
    {".png", [](const fs::path& file) { stereo::ReadScaledDisparity(file, 4.0); }},
    {".json",
     [](const fs::path& file) {
       const Result<explorer::SavedExploration> saved = explorer::LoadExploration(file);
       if (!saved) throw std::runtime_error(saved.error());
     }},
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Format& format = kFormats[data[0] % std::size(kFormats)];
  const fs::path& file = FileWith(data + 1, size - 1, format.extension);
  try {
    format.read(file);
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).find(file.string()) == std::string::npos) __builtin_trap();
  }
  return 0;
}
