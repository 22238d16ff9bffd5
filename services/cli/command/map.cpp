#include <fmt/format.h>

#include <functional>
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

/// Loads maps of one place and hands them over in their order. Each file is read once, since it may be a
/// pipe. Point clouds and meshes get the voxel size of the first map among them, whose file may come after
/// theirs.
void ForEachMap(const std::vector<Path>& files, const std::function<void(LoadedMap, const Path&)>& take) {
  std::optional<double> voxel_size;
  std::vector<MapOrShape> waiting;
  std::size_t taken = 0;
  for (const Path& file : files) {
    waiting.push_back(mapper::LoadMapOrShape(file));
    const auto* const map = std::get_if<LoadedMap>(&waiting.back());
    if (!voxel_size && map != nullptr) voxel_size = map->map.grid.voxel_size();
    if (!voxel_size) continue;
    for (MapOrShape& loaded : waiting) {
      const Path& its_file = files[taken++];
      take(mapper::AsMap(std::move(loaded), its_file, voxel_size), its_file);
    }
    waiting.clear();
  }
  // None of the files has voxels.
  if (!waiting.empty()) mapper::AsMap(std::move(waiting.front()), files.front(), std::nullopt);
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
                      "Also write what was free and is occupied (green) and the reverse (red), as .ply");
  command->callback([args, &exit_code] {
    if (!args->out.empty()) mapper::CheckMapExtension(args->out);
    std::vector<LoadedMap> maps;
    ForEachMap({args->first, args->second},
               [&](LoadedMap loaded, const Path&) { maps.push_back(std::move(loaded)); });
    const mapper::MapDifference difference = mapper::DifferenceOf(maps[0].map.grid, maps[1].map.grid);
    fmt::print("{}", mapper::Describe(difference));
    if (!args->out.empty()) {
      mapper::SaveMapAs(mapper::PaintedDifference(difference, maps[0].map.grid.voxel_size()), args->out);
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
    const ColoredMap cropped = mapper::Crop(LoadWithVoxelSize(args->in, args->voxel_size), box_W);
    if (cropped.grid.block_count() == 0)
      throw std::runtime_error(args->in.string() + ": no known voxel of it lies in the box");
    mapper::SaveMapAs(cropped, args->out);
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
    std::optional<ColoredMap> merged;
    ForEachMap(args->files, [&](LoadedMap loaded, const Path& file) {
      if (!merged) {
        merged.emplace(std::move(loaded.map));
        return;
      }
      try {
        mapper::Merge(loaded.map, *merged);
      } catch (const std::invalid_argument& error) {
        throw std::runtime_error(file.string() + ": " + error.what());
      }
    });
    mapper::SaveMapAs(*merged, args->out);
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
