#include "services/cli/adapter/truth_judge.h"

#include <algorithm>
#include <chrono>
#include <exception>

#include "common/base/check.h"
#include "common/scenario/models.h"
#include "services/evaluator/core/surface_truth.h"
#include "services/simulator/adapter/load_mesh.h"

namespace thalweg::cli {

void TruthJudge::Begin(const Scenario& scenario, const Eigen::Vector3d& start_W, double voxel_size) {
  begun_ = true;
  simulator::TrueMap::Options options;
  options.voxel_size = voxel_size;
  options.robot = RobotFrom(scenario);
  const DepthSensorModel sensor = DepthSensorFrom(scenario);
  options.camera = sensor.camera;
  options.view_range = MapFrom(scenario).SeenRange(sensor.max_range);
  computing_ = std::async(std::launch::async, [scenario, start_W, options] {
    simulator::World world = simulator::LoadWorld(scenario);
    simulator::CheckExtent(world, options.voxel_size);
    simulator::TrueMap map(world, start_W, options);
    return std::make_unique<Truth>(Truth{std::move(world), start_W, options, std::move(map)});
  });
}

const simulator::TrueMap* TruthJudge::Poll() {
  const bool ready =
      computing_.valid() && computing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  return ready ? Wait() : truth_ ? &truth_->map : nullptr;
}

const simulator::TrueMap* TruthJudge::Wait() {
  if (computing_.valid()) {
    try {
      truth_ = computing_.get();
    } catch (const std::exception& error) {
      error_ = error.what();
    }
  }
  return truth_ ? &truth_->map : nullptr;
}

bool TruthJudge::Observable(const VoxelIndex& voxel) const {
  THALWEG_CHECK(truth_ != nullptr);
  return truth_->map.Observable(voxel);
}

std::optional<double> TruthJudge::ObservableSurface() {
  if (Wait() == nullptr) return std::nullopt;
  return evaluator::SurfaceTruth::Of(truth_->world, truth_->map, truth_->options, truth_->start_W).area();
}

}  // namespace thalweg::cli
