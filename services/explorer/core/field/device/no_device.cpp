#include "services/explorer/core/field/device/device_solver.h"

namespace thalweg::explorer::field::device {

std::unique_ptr<DeviceSolver> OpenDeviceSolver(std::string& why) {
  why = "this build has no solver for a GPU (-DTHALWEG_CUDA=ON)";
  return nullptr;
}

}  // namespace thalweg::explorer::field::device
