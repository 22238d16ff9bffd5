#include <fmt/format.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/text.h"
#include "services/cli/command/command.h"
#include "services/cli/command/number_range.h"
#include "services/mapper/adapter/describe.h"
#include "services/mapper/adapter/map_formats.h"
#include "services/mapper/core/map_operations.h"

namespace thalweg::cli {
namespace {

using mapper::ColoredMap;
using mapper::LoadedMap;
using mapper::LoadMap;
using mapper::MapOrShape;
using Path = std::filesystem::path;

constexpr auto kReads = ".ot, .bt, .ply or checkpoint.map";
constexpr auto kWrites = ".ot, .bt, .ply or .map";

void AddVoxelSize(CLI::App& command, double& voxel_size) {
  command
      .add_option(
          "--voxel-size", voxel_size,
          "[m] A multiple of the map's; a voxel is occupied where one within is. Any for a point cloud or "
          "mesh, which needs it")
      ->check(NumberFrom(0.001, 1e9));
}

/// @param voxel_size  [m] 0 = that of the file.
ColoredMap LoadWithVoxelSize(const Path& file, double voxel_size) {
  if (voxel_size == 0.0) return LoadMap(file).map;
  ColoredMap map = LoadMap(file, voxel_size).map;
  const double fine_size = map.grid.voxel_size();
  const std::optional<int> factor = mapper::CoarseningFactor(fine_size, voxel_size);
  if (!factor) {
    throw std::runtime_error(
        fmt::format("--voxel-size must be a multiple of the map's {} m", NumberText(fine_size)));
  }
  return *factor > 1 ? mapper::Coarsen(map, *factor) : std::move(map);
}

/// Loads the first of maps of one place. A point cloud or mesh gets the voxel size of the first map after it.
LoadedMap LoadFirst(const std::vector<Path>& files) {
  MapOrShape first = mapper::LoadMapOrShape(files.front());
  if (auto* const map = std::get_if<LoadedMap>(&first)) return std::move(*map);
  for (std::size_t k = 1; k < files.size(); ++k) {
    const MapOrShape other = mapper::LoadMapOrShape(files[k]);
    if (const auto* const map = std::get_if<LoadedMap>(&other)) {
      return LoadMap(files.front(), map->map.grid.voxel_size());
    }
  }
  return LoadMap(files.front());
}

void AddMapInfo(CLI::App& map) {
  const auto files = std::make_shared<std::vector<Path>>();
  CLI::App* command = map.add_subcommand("info", "Print what maps hold");
  command->add_option("files", *files, kReads)->required();
  command->callback([files] {
    for (const Path& file : *files) {
      const std::string text = std::visit([](const auto& loaded) { return mapper::Describe(loaded); },
                                          mapper::LoadMapOrShape(file));
      fmt::print("{}\n{}", file.string(), text);
    }
  });
}

void AddMapConvert(CLI::App& map) {
  struct Args {
    Path in, out;
    double voxel_size = 0.0;
  };
  const auto args = std::make_shared<Args>();
  CLI::App* command = map.add_subcommand(
      "convert",
      "Write a map in another format, or with larger voxels, or make one of a point cloud or mesh");
  command->add_option("in", args->in, kReads)->required();
  command->add_option("out", args->out, kWrites)->required();
  AddVoxelSize(*command, args->voxel_size);
  command->callback([args] {
    mapper::CheckMapExtension(args->out);
    mapper::SaveMapAs(LoadWithVoxelSize(args->in, args->voxel_size), args->out);
  });
}

void AddMapDiff(CLI::App& map, int& exit_code) {
  struct Args {
    Path first, second, out;
  };
  const auto args = std::make_shared<Args>();
  CLI::App* command =
      map.add_subcommand("diff", "Compare two maps of one place, voxel by voxel; exit code 1 if they differ");
  command->add_option("first", args->first, kReads)->required();
  command->add_option("second", args->second, kReads)->required();
  command->add_option("-o,--out", args->out,
                      "Also write what appeared (green) and what vanished (red), as .ply");
  command->callback([args, &exit_code] {
    if (!args->out.empty()) mapper::CheckMapExtension(args->out);
    const LoadedMap first = LoadFirst({args->first, args->second});
    const LoadedMap second = LoadMap(args->second, first.map.grid.voxel_size());
    const mapper::MapDifference difference = mapper::DifferenceOf(first.map.grid, second.map.grid);
    fmt::print("{}", mapper::Describe(difference));
    if (!args->out.empty()) {
      mapper::SaveMapAs(mapper::PaintedDifference(difference, first.map.grid.voxel_size()), args->out);
    }
    exit_code = difference.differing() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
  });
}

void AddMapCrop(CLI::App& map) {
  struct Args {
    Path in, out;
    std::vector<double> low, high;
    double voxel_size = 0.0;
  };
  const auto args = std::make_shared<Args>();
  CLI::App* command = map.add_subcommand("crop", "Keep the voxels whose centers lie in a box");
  command->add_option("in", args->in, kReads)->required();
  command->add_option("out", args->out, kWrites)->required();
  command->add_option("--min", args->low, "[m] Lowest corner: X Y Z")->expected(3)->required();
  command->add_option("--max", args->high, "[m] Highest corner: X Y Z")->expected(3)->required();
  AddVoxelSize(*command, args->voxel_size);
  command->callback([args] {
    mapper::CheckMapExtension(args->out);
    const Eigen::AlignedBox3d box_W(Eigen::Vector3d(args->low[0], args->low[1], args->low[2]),
                                    Eigen::Vector3d(args->high[0], args->high[1], args->high[2]));
    if (box_W.isEmpty()) throw std::runtime_error("--min must not be above --max");
    mapper::SaveMapAs(mapper::Crop(LoadWithVoxelSize(args->in, args->voxel_size), box_W), args->out);
  });
}

void AddMapMerge(CLI::App& map) {
  struct Args {
    std::vector<Path> files;
    Path out;
  };
  const auto args = std::make_shared<Args>();
  CLI::App* command = map.add_subcommand(
      "merge", "Add the log-odds of maps of one place, in one frame, as if one had seen all");
  command->add_option("files", args->files, kReads)->required();
  command->add_option("-o,--out", args->out, kWrites)->required();
  command->callback([args] {
    mapper::CheckMapExtension(args->out);
    ColoredMap merged = LoadFirst(args->files).map;
    for (std::size_t k = 1; k < args->files.size(); ++k) {
      try {
        mapper::Merge(LoadMap(args->files[k], merged.grid.voxel_size()).map, merged);
      } catch (const std::invalid_argument& error) {
        throw std::runtime_error(args->files[k].string() + ": " + error.what());
      }
    }
    mapper::SaveMapAs(merged, args->out);
  });
}

}  // namespace

void AddMap(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("map", "Look into maps on disk: info, convert, diff, crop, merge");
  command->require_subcommand(1);
  AddMapInfo(*command);
  AddMapConvert(*command);
  AddMapDiff(*command, exit_code);
  AddMapCrop(*command);
  AddMapMerge(*command);
}

}  // namespace thalweg::cli
