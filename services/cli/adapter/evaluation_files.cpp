#include "services/cli/adapter/evaluation_files.h"

#include <map>
#include <utility>

#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "services/cli/report/evaluation_page.h"
#include "services/cli/report/evaluation_report.h"
#include "services/evaluator/adapter/scene.h"

namespace thalweg::cli {

OccupancyGrid GridOf(const simulator::TrueMap& truth, double voxel_size) {
  OccupancyGrid grid(voxel_size);
  for (std::size_t k = 0; k < truth.voxels().size(); ++k) {
    const simulator::TrueVoxel kind = truth.voxels()[k];
    if (kind == simulator::TrueVoxel::kFree) grid.Set(truth.voxels().IndexAt(k), -1.0F);
    if (kind == simulator::TrueVoxel::kSurface) grid.Set(truth.voxels().IndexAt(k), 1.0F);
  }
  return grid;
}

void WriteEvaluation(const std::vector<evaluator::Outcome>& outcomes,
                     const evaluator::Campaign::Options& campaign, const std::filesystem::path& folder) {
  std::map<std::string, WorldPicture> worlds;
  for (const std::string& name : campaign.scenarios) {
    const evaluator::Scene scene(name, campaign.overrides);
    const auto truth = scene.Truth(scene.Start(campaign.seed).translation());
    const OccupancyGrid grid = GridOf(*truth, scene.Options("", 0).mapper.voxel_size);
    worlds[scene.name()] = PictureOf(LookFromAbove(grid));
    for (const auto& [kind, picture] : {std::pair("coverage", DrawCoverageCurves(outcomes, scene.name())),
                                        std::pair("paths", DrawPaths(outcomes, scene.name(), 0, grid))}) {
      WritePicture(folder / (scene.name() + "-" + kind + ".png"), picture);
    }
  }
  WriteFile(folder / "index.html", EvaluationHtml(outcomes, worlds, campaign.overrides));
}

}  // namespace thalweg::cli
