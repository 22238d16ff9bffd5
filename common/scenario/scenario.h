#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/geometry/depth_error.h"
#include "common/geometry/robot_model.h"
#include "scenario.pb.h"

namespace thalweg {

/// Reads a scenario: a path, or a name under deploy/scenarios. Then applies `overrides`, each
/// "mapper.voxel_size_m=0.05". Relative world files become absolute, ${THALWEG_DATA} is replaced.
/// Throws std::runtime_error naming file, line, column and field of each mistake: unknown field, wrong type,
/// value out of range, fields that contradict each other (see CheckScenario), missing world file.
/// @param with_defaults  Fills in what is absent, for the checks alone: who knows the services' defaults
/// finds
///                       out, too, when a field contradicts another's default.
Scenario LoadScenario(const std::string& name_or_file, const std::vector<std::string>& overrides = {},
                      const std::function<Scenario(const Scenario&)>& with_defaults = nullptr);

/// Throws std::invalid_argument naming field, value and what is allowed.
void CheckScenario(const Scenario& scenario);

/// As Protobuf text, with everything resolved, for the processes of a run and for the record.
void SaveScenario(const Scenario& scenario, const std::filesystem::path& file);

/// What several services share, out of the scenario; defaults stand in the structs.
RobotModel RobotFrom(const Scenario& scenario);
DepthSensorModel DepthSensorFrom(const Scenario& scenario);
Eigen::Vector3d ToEigen(const Vector3& v);
/// [m] Boxes of W in which no part of the robot may be, and nothing is explored.
std::vector<Eigen::AlignedBox3d> NoGoFrom(const Scenario& scenario);

/// Of the mapper's clouds: as stated in `mapper`, else what the depth sensor's noise makes.
DepthErrorModel DepthErrorFrom(const Scenario& scenario);

/// Whether the mapper's clouds come from matched images and not from a depth sensor.
bool DepthComesFromStereo(const Scenario& scenario);

/// Folder of the shipped scenarios: THALWEG_SCENARIOS; else, of an installed program, share/thalweg/scenarios
/// beside its bin; else deploy/scenarios, found upwards from the executable. Throws std::runtime_error when
/// there is none.
std::filesystem::path ScenarioFolder();

}  // namespace thalweg
