#include "services/cli/adapter/truth_judge.h"

#include <algorithm>
#include <chrono>
#include <exception>

#include "common/base/check.h"
#include "common/scenario/models.h"
#include "services/simulator/adapter/load_mesh.h"

namespace thalweg::cli {

void TruthJudge::Begin(const Scenario& scenario, const Eigen::Vector3d& start_W, double voxel_size) {
  begun_ = true;
  simulator::TrueMap::Options options;
  options.voxel_size = voxel_size;
  options.robot = RobotFrom(scenario);
  const DepthSensorModel sensor = DepthSensorFrom(scenario);
  options.camera = sensor.camera;
  options.view_range = std::min(MapFrom(scenario).max_range, sensor.max_range);
  computing_ = std::async(std::launch::async, [scenario, start_W, options] {
    const simulator::World world = simulator::LoadWorld(scenario);
    simulator::CheckExtent(world, options.voxel_size);
    return simulator::TrueMap(world, start_W, options);
  });
}

const simulator::TrueMap* TruthJudge::Poll() {
  const bool ready =
      computing_.valid() && computing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  return truth_ || !ready ? (truth_ ? &*truth_ : nullptr) : Wait();
}

const simulator::TrueMap* TruthJudge::Wait() {
  if (computing_.valid()) {
    try {
      truth_ = computing_.get();
    } catch (const std::exception& error) {
      error_ = error.what();
    }
  }
  return truth_ ? &*truth_ : nullptr;
}

bool TruthJudge::Observable(const VoxelIndex& voxel) const {
  THALWEG_CHECK(truth_.has_value());
  return truth_->Observable(voxel);
}

}  // namespace thalweg::cli
