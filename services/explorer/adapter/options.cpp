#include "services/explorer/adapter/options.h"

#include <algorithm>

namespace thalweg::explorer {
namespace {

PotentialOptions::Cluster FromProto(thalweg::Potential::Cluster cluster) {
  using Cluster = PotentialOptions::Cluster;
  switch (cluster) {
    case thalweg::Potential::FLUX:
      return Cluster::kFlux;
    case thalweg::Potential::FLUX_PER_LENGTH:
      return Cluster::kFluxPerLength;
    default:
      return Cluster::kStreamline;
  }
}

PotentialOptions::Way FromProto(thalweg::Potential::Way way) {
  using Way = PotentialOptions::Way;
  switch (way) {
    case thalweg::Potential::SHORTEST:
      return Way::kShortest;
    case thalweg::Potential::TRACE_BACK:
      return Way::kTraceBack;
    default:
      return Way::kStreamline;
  }
}

}  // namespace

Explorer::Options OptionsFrom(const Scenario& scenario) {
  Explorer::Options options;
  options.robot = RobotFrom(scenario);
  const DepthSensorModel sensor = DepthSensorFrom(scenario);
  options.camera = sensor.camera;
  if (scenario.mapper().has_max_range_m()) options.sensor_range = scenario.mapper().max_range_m();
  options.sensor_range = std::min(options.sensor_range, sensor.max_range);
  if (scenario.mapper().has_voxel_size_m()) options.voxel_size = scenario.mapper().voxel_size_m();
  // Nothing is mapped beyond, however long it is looked at.
  options.look_range = std::min(
      {options.look_range, options.sensor_range, DepthErrorFrom(scenario).SureRange(options.voxel_size)});
  if (scenario.world().has_bounds_min_m() && scenario.world().has_bounds_max_m()) {
    options.bounds = Eigen::AlignedBox3d(ToEigen(scenario.world().bounds_min_m()),
                                         ToEigen(scenario.world().bounds_max_m()));
  }
  options.no_go = NoGoFrom(scenario);
  const thalweg::Explorer& given = scenario.explorer();
  if (given.has_strategy()) options.strategy.name = given.strategy();
  if (given.has_min_cluster_area_m2()) options.frontier.min_area = given.min_cluster_area_m2();
  if (given.has_cluster_extent_m()) options.frontier.extent = given.cluster_extent_m();
  if (given.has_look_range_m()) options.look_range = given.look_range_m();
  if (given.has_looks_before_set_aside()) options.memory.looks = given.looks_before_set_aside();
  if (given.has_look_around_min_area_m2()) options.look_around_min_area = given.look_around_min_area_m2();
  if (given.has_set_aside_expiry_s()) options.memory.expiry = FromSeconds(given.set_aside_expiry_s());
  if (given.has_safety_margin_m()) options.safety_margin = given.safety_margin_m();
  if (given.has_time_budget_s()) options.time_budget = FromSeconds(given.time_budget_s());
  if (given.has_distance_budget_m()) options.distance_budget = given.distance_budget_m();
  if (given.has_return_home()) options.return_home = given.return_home();
  if (given.has_home_margin()) options.home_margin = given.home_margin();
  if (given.has_min_measured_share()) options.min_measured_share = given.min_measured_share();
  if (given.has_max_missed_share()) options.max_missed_share = given.max_missed_share();
  if (given.doubt().has_max_log_odds()) options.doubt.max_log_odds = given.doubt().max_log_odds();
  if (given.doubt().has_weight()) options.doubt.weight = given.doubt().weight();
  if (given.has_comfort_m()) options.comfort.distance = given.comfort_m();
  if (given.has_random_seed()) options.strategy.seed = static_cast<std::uint32_t>(given.random_seed());
  const thalweg::Potential& potential = given.potential();
  PotentialOptions& field = options.strategy.potential;
  if (potential.has_source_radius_m()) field.source_radius = potential.source_radius_m();
  if (potential.has_screening_length_m()) field.screening_length = potential.screening_length_m();
  if (potential.has_relative_residual()) field.relative_residual = potential.relative_residual();
  if (potential.has_cluster()) field.cluster = FromProto(potential.cluster());
  if (potential.has_way()) field.way = FromProto(potential.way());
  if (potential.has_seal()) field.seal = potential.seal();
  const thalweg::InformationGain& gain = given.gain();
  if (gain.has_sample_share()) options.strategy.gain.sample_share = gain.sample_share();
  if (gain.has_decay_per_m()) options.strategy.gain.decay = gain.decay_per_m();
  const thalweg::Flow& flow = given.flow();
  if (flow.has_eagerness()) options.strategy.flow.eagerness = flow.eagerness();
  if (flow.has_hysteresis()) options.strategy.flow.hysteresis = flow.hysteresis();
  if (flow.has_sight_worth()) options.strategy.flow.sight_worth = flow.sight_worth();
  return options;
}

}  // namespace thalweg::explorer
