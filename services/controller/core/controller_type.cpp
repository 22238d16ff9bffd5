#include "services/controller/core/controller_type.h"

#include "common/base/check.h"
#include "services/controller/core/stop_and_turn.h"

namespace thalweg::controller {

std::unique_ptr<MotionController> MakeController(ControllerType type, const PathFollower::Options& options) {
  switch (type) {
    case ControllerType::kPathFollower:
      return std::make_unique<PathFollower>(options);
    case ControllerType::kStopAndTurn:
      return std::make_unique<StopAndTurn>(options);
  }
  THALWEG_CHECK(!"a type without a controller");
  return nullptr;
}

}  // namespace thalweg::controller
