#include "services/explorer/adapter/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "common/scenario/models.h"
#include "common/scenario/option_binding.h"
#include "services/explorer/adapter/exploration_file.h"

namespace thalweg::explorer {

void Visit(OptionVisitor& visitor, Explorer::Options& options) {
  visitor.Number("min_cluster_area_m2", options.frontier.min_area);
  visitor.Number("cluster_extent_m", options.frontier.extent);
  visitor.Number("look_range_m", options.look_range);
  visitor.Whole("looks_before_set_aside", options.memory.looks);
  visitor.Number("look_around_min_area_m2", options.look_around_min_area);
  visitor.Seconds("set_aside_expiry_s", options.memory.expiry);
  visitor.Number("safety_margin_m", options.safety_margin);
  visitor.Seconds("time_budget_s", options.time_budget);
  visitor.Number("distance_budget_m", options.distance_budget);
  visitor.Switch("return_home", options.return_home);
  visitor.Number("home_margin", options.home_margin);
  visitor.Number("min_measured_share", options.min_measured_share);
  visitor.Number("max_missed_share", options.max_missed_share);
  visitor.Seconds("shut_way_patience_s", options.shut_way_patience);
  visitor.Number("comfort_m", options.comfort.distance);
  visitor.Block("doubt", [&](OptionVisitor& doubt) {
    doubt.Number("max_log_odds", options.doubt.max_log_odds);
    doubt.Number("weight", options.doubt.weight);
  });
  visitor.Block("loop", [&](OptionVisitor& loop) {
    LoopRules::Set set = options.loop.set;
    if (loop.Choice("rules", set, {{"OURS", LoopRules::Set::kOurs}, {"PRINTED", LoopRules::Set::kPrinted}}))
      options.loop = LoopRules::Of(set);
    loop.Switch("look_around", options.loop.look_around);
    loop.Switch("scan_on_the_way", options.loop.scan_on_the_way);
    loop.Switch("drop_small", options.loop.drop_small);
    loop.Switch("set_aside", options.loop.set_aside);
    loop.Switch("stop_short", options.loop.stop_short);
    loop.Switch("keep_off", options.loop.keep_off);
    loop.Switch("pull_straight", options.loop.pull_straight);
    loop.Switch("face_target", options.loop.face_target);
    loop.Switch("wait_at_shut_ways", options.loop.wait_at_shut_ways);
    loop.Switch("go_tight_ways", options.loop.go_tight_ways);
  });
  visitor.Choice("minimize", options.minimize, {{"PATH", Minimize::kPath}, {"TIME", Minimize::kTime}});
  Visit(visitor, options.strategy);
}

namespace {

std::vector<std::string> StrategyNames() {
  std::vector<std::string> names;
  for (const StrategyInfo& strategy : Strategies()) names.emplace_back(strategy.name);
  return names;
}

/// A strategy with the options that the scenario gives it.
ConfiguredStrategy StrategyFrom(Scenario scenario, std::string_view name) {
  const std::vector<std::string> names = StrategyNames();
  if (std::ranges::count(names, name) == 0)
    throw std::invalid_argument("the strategy " + NotOneOf(names, std::string(name)));
  scenario.mutable_explorer()->set_strategy(std::string(name));
  Explorer::Options options;
  ReadOptions(scenario.explorer(), options);
  return options.strategy;
}

}  // namespace

Explorer::Options OptionsFrom(const Scenario& scenario) {
  Explorer::Options options;
  options.robot = RobotFrom(scenario);
  const DepthSensorModel sensor = DepthSensorFrom(scenario);
  const MapModel map = MapFrom(scenario);
  options.camera = sensor.camera;
  options.sensor_range = map.SeenRange(sensor.max_range);
  options.voxel_size = map.voxel_size;
  // Nothing is mapped beyond, however long it is looked at.
  options.look_range = std::min(
      {options.look_range, options.sensor_range, DepthErrorFrom(scenario).SureRange(options.voxel_size)});
  if (scenario.world().has_bounds_min_m() && scenario.world().has_bounds_max_m()) {
    options.bounds = Eigen::AlignedBox3d(ToEigen(scenario.world().bounds_min_m()),
                                         ToEigen(scenario.world().bounds_max_m()));
  }
  options.no_go = NoGoFrom(scenario);
  ReadOptions(scenario.explorer(), options);
  options.configure = [scenario](std::string_view name) { return StrategyFrom(scenario, name); };
  return options;
}

std::string PlaceOf(const Scenario& scenario) {
  const World& world = scenario.world();
  std::string place =
      fmt::format("\"{}\", {}", scenario.title(), std::filesystem::path(world.file()).filename().string());
  for (const auto& [is_set, corner] : {std::pair(world.has_bounds_min_m(), world.bounds_min_m()),
                                       std::pair(world.has_bounds_max_m(), world.bounds_max_m())}) {
    place += is_set ? fmt::format(", ({:g}, {:g}, {:g})", corner.x(), corner.y(), corner.z()) : ", no bound";
  }
  return place.substr(0, kLongestPlace);
}

std::vector<Mistake> MistakesIn(const Scenario& scenario) {
  const std::string& name = scenario.explorer().strategy();
  const std::vector<std::string> names = StrategyNames();
  if (!scenario.explorer().has_strategy()) return {};
  if (std::ranges::count(names, name) == 0)
    return {{.field = PathOf("explorer", "strategy"), .text = NotOneOf(names, name)}};
  if (const std::optional<RobotMisfit> misfit = MisfitOf(RobotFrom(scenario), name)) {
    return {{.field = PathOf("explorer", "strategy"),
             .text = fmt::format("is \"{}\", which is for {}, and robot.{} is {}", name, misfit->robots,
                                 misfit->field, misfit->value),
             .other = PathOf("robot", misfit->field)}};
  }
  return {};
}

}  // namespace thalweg::explorer
