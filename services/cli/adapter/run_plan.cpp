#include "services/cli/adapter/run_plan.h"

#include <algorithm>
#include <stdexcept>

#include "common/service/service.h"
#include "services/mapper/adapter/mapper_service.h"

namespace thalweg::cli {

std::vector<std::string> ServicesOf(const Scenario& scenario) {
  std::vector<std::string> names;
  if (scenario.depth_source() == DepthSource::STEREO) names.emplace_back(kStereo);
  names.insert(names.end(), {kMapper, kExplorer, kController});
  if (scenario.odometry_source() == OdometrySource::VISUAL_ODOMETRY) names.emplace_back(kVisualOdometry);
  names.emplace_back(kSimulator);  // last, so that nobody misses its first image
  return names;
}

std::vector<std::string> ServicesOf(const Scenario& scenario, const std::vector<std::string>& without) {
  std::vector<std::string> names = ServicesOf(scenario);
  for (const std::string& name : without) {
    if (std::erase(names, name) > 0) continue;
    throw std::runtime_error("--without " + name + ": the scenario has no such service; it has " +
                             Listed(ServicesOf(scenario)));
  }
  return names;
}

std::string NeedsText(const Scenario& scenario) {
  std::vector<std::string> names = ServicesOf(scenario, {kSimulator});
  names.emplace_back("a robot");
  return Listed(names);
}

void KeepToThisMachine(Scenario& scenario, bool all_here) {
  const dds::BusOptions named = BusOptionsFrom(scenario, {}, "thalweg");
  const bool is_named = scenario.network().has_local_only() || !named.network_interface.empty() ||
                        !named.discovery_server.empty() || !named.peers.empty();
  if (!is_named && all_here) scenario.mutable_network()->set_local_only(true);
}

void CheckPathsWithMapper(Scenario& scenario, const std::vector<std::string>& services) {
  if (scenario.controller().has_check_paths() || std::ranges::count(services, kMapper) == 0) return;
  scenario.mutable_controller()->set_check_paths(true);
}

std::string IntroductionText(const Scenario& scenario, const std::vector<std::string>& without,
                             bool with_surface, const std::filesystem::path& folder) {
  std::vector<std::string> services = ServicesOf(scenario, without);
  if (with_surface) services.emplace_back(kSurface);
  std::string text = "Starting " + Listed(services) + ".";
  std::vector<std::string> elsewhere = without;
  if (std::erase(elsewhere, kSimulator) > 0) {
    text += " Expecting a robot: odometry and " + std::string(dds::topics::DepthPoints::kName) +
            ", or what takes their place in the scenario.";
  }
  if (!elsewhere.empty()) text += " Expecting " + Listed(elsewhere) + " to be started elsewhere.";
  if (scenario.network().local_only()) {
    text += " Other machines are ignored (--set network.local_only=false admits them).";
  }
  if (const std::string map = mapper::MapperService::kCheckpointFile; std::filesystem::exists(folder / map)) {
    text += " The mapper resumes from " + map + " in that folder if it can (see mapper.log).";
  }
  return text;
}

std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t n = 0; n < names.size(); ++n) {
    text += (n == 0 ? "" : n + 1 == names.size() ? " and " : ", ") + names[n];
  }
  return text;
}

}  // namespace thalweg::cli
