#pragma once

#include "common/scenario/scenario.h"
#include "services/evaluator/core/stereo_sensor.h"

namespace thalweg::evaluator {

/// A scenario's stereo camera and matcher, whether or not its depth comes from them. On one thread.
/// Throws std::runtime_error as stereo::OptionsFrom does.
StereoSensor::Options StereoSensorFrom(const Scenario& scenario);

}  // namespace thalweg::evaluator
