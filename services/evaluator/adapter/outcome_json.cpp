#include "services/evaluator/adapter/outcome_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "services/evaluator/core/summary.h"
#include "services/evaluator/text/run_end_text.h"

namespace thalweg::evaluator {
namespace {

using Json = nlohmann::ordered_json;

Json OrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json JsonOf(const PairedRatio& ratio, const Comparison::Decided& decided) {
  return {
      {"ratio", OrNull(ratio.mean)},    {"ci95", {OrNull(ratio.interval.low), OrNull(ratio.interval.high)}},
      {"p", OrNull(ratio.p)},           {"pairs", ratio.pairs},
      {"worlds", ratio.worlds},         {"worlds_shorter", decided.shorter},
      {"worlds_longer", decided.longer}};
}

Json JsonOf(const Tail& tail) {
  Json json = {{"begins_m", tail.begins ? Json(*tail.begins) : Json(nullptr)}, {"other_m", tail.other}};
  Json& journeys = json["journeys"] = Json::array();
  for (const Tail::Journey& journey : tail.journeys) {
    journeys.push_back({{"length_m", journey.length},
                        {"target_voxels", journey.voxels},
                        {"kind", NameOf(journey.kind)},
                        {"was_in_sight", journey.was_in_sight}});
  }
  return json;
}

/// Throws nlohmann::json::exception as its parts do.
Result<Tail> TailFrom(const nlohmann::json& json) {
  Tail tail;
  if (!json.at("begins_m").is_null()) tail.begins = json.at("begins_m").get<double>();
  json.at("other_m").get_to(tail.other);
  for (const auto& entry : json.at("journeys")) {
    const auto text = entry.at("kind").get<std::string>();
    const std::optional<Tail::Kind> kind = TailKindNamed(text);
    if (!kind) return Error{"a journey of the unknown kind \"" + text + "\""};
    tail.journeys.push_back(
        {entry.at("length_m"), entry.at("target_voxels"), *kind, entry.at("was_in_sight")});
  }
  return tail;
}

Json JsonOf(const MotionFigures& motion) {
  return {{"moving_s", motion.moving},
          {"turning_s", motion.turning},
          {"standing_s", motion.standing},
          {"stops", motion.stops},
          {"most_speed_mps", motion.most_speed},
          {"most_acceleration_mps2", motion.most_acceleration},
          {"most_jerk_mps3", motion.most_jerk},
          {"most_sideways_speed_mps", motion.most_sideways_speed},
          {"sharpest_curve_per_m", motion.sharpest_curve},
          {"most_turn_rate_radps", motion.most_turn_rate},
          {"most_turn_acceleration_radps2", motion.most_turn_acceleration}};
}

/// Throws nlohmann::json::exception as its parts do.
MotionFigures MotionFrom(const nlohmann::json& json) {
  return {.moving = json.at("moving_s"),
          .turning = json.at("turning_s"),
          .standing = json.at("standing_s"),
          .stops = json.at("stops"),
          .most_speed = json.at("most_speed_mps"),
          .most_acceleration = json.at("most_acceleration_mps2"),
          .most_jerk = json.value("most_jerk_mps3", 0.0),  // older ones do not have it
          .most_sideways_speed = json.at("most_sideways_speed_mps"),
          .sharpest_curve = json.value("sharpest_curve_per_m", 0.0),  // likewise
          .most_turn_rate = json.at("most_turn_rate_radps"),
          .most_turn_acceleration = json.at("most_turn_acceleration_radps2")};
}

Json JsonOf(const Summary::OfOptimum& of) {
  return {{"ratio", OrNull(of.ratio)}, {"runs", of.runs}, {"tour_mean_m", OrNull(of.tour)}};
}

Json JsonOf(const Summary::TailFigures& tail) {
  Json json = {{"runs", tail.runs},
               {"to_95_mean_m", OrNull(tail.begins)},
               {"length_mean_m", OrNull(tail.length)},
               {"journeys_mean", OrNull(tail.journeys)},
               {"journey_median_m", OrNull(tail.median)},
               {"long_share", OrNull(tail.long_share)},
               {"long_length_share", OrNull(tail.long_length_share)},
               {"target_median_voxels", OrNull(tail.target)},
               {"small_target_length_share", OrNull(tail.small_length_share)},
               {"in_sight_length_share", OrNull(tail.in_sight_length_share)}};
  Json& shares = json["length_shares"] = Json::object();
  for (const auto& [kind, share] : tail.length_shares) shares[std::string(NameOf(kind))] = OrNull(share);
  return json;
}

Json JsonOf(const SurfaceFigures& surface) {
  return {{"observable_m2", surface.observable},
          {"seen", surface.seen},
          {"inspected", surface.inspected},
          {"fine", surface.fine},
          {"mesh_m2", surface.mesh_area},
          {"mesh_to_truth_m", surface.mesh_to_truth},
          {"truth_to_mesh_m", surface.truth_to_mesh},
          {"f_2cm", surface.f_near},
          {"f_voxel", surface.f_voxel}};
}

/// Throws nlohmann::json::exception as its parts do.
SurfaceFigures SurfaceFrom(const nlohmann::json& json) {
  return {.observable = json.at("observable_m2"),
          .seen = json.at("seen"),
          .inspected = json.at("inspected"),
          .fine = json.at("fine"),
          .mesh_area = json.at("mesh_m2"),
          .mesh_to_truth = json.at("mesh_to_truth_m"),
          .truth_to_mesh = json.at("truth_to_mesh_m"),
          .f_near = json.at("f_2cm"),
          .f_voxel = json.at("f_voxel")};
}

}  // namespace

Json ToJson(const OfflineTours& tours) {
  Json json = {{"places", tours.places},
               {"spacing_m", tours.spacing},
               {"iterations", tours.iterations},
               {"out_of_time", tours.out_of_time}};
  Json& list = json["tours"] = Json::array();
  for (std::size_t k = 0; k < kTourCoverages.size(); ++k) {
    const OfflineTour& tour = tours.to[k];
    list.push_back({{"to", kTourCoverages[k]},
                    {"length_m", tour.length ? Json(*tour.length) : Json(nullptr)},
                    {"coverage", tour.coverage},
                    {"stops", tour.stops}});
    Json& path = list.back()["path"] = Json::array();
    for (const Eigen::Vector3d& p_W : tour.path_W) path.push_back({p_W.x(), p_W.y(), p_W.z()});
  }
  return json;
}

Result<OfflineTours> OfflineToursFromJson(const nlohmann::json& json) try {
  OfflineTours tours;
  json.at("places").get_to(tours.places);
  json.at("spacing_m").get_to(tours.spacing);
  json.at("iterations").get_to(tours.iterations);
  json.at("out_of_time").get_to(tours.out_of_time);
  for (std::size_t k = 0; k < kTourCoverages.size(); ++k) {
    const auto& entry = json.at("tours").at(k);
    if (entry.at("to").get<double>() != kTourCoverages.at(k)) return Error{"tours to other coverages"};
    OfflineTour& tour = tours.to.at(k);
    if (!entry.at("length_m").is_null()) tour.length = entry.at("length_m").get<double>();
    entry.at("coverage").get_to(tour.coverage);
    entry.at("stops").get_to(tour.stops);
    for (const auto& place : entry.at("path")) {
      const auto p_W = place.get<std::array<double, 3>>();
      tour.path_W.emplace_back(p_W[0], p_W[1], p_W[2]);
    }
  }
  return tours;
} catch (const nlohmann::json::exception& error) {
  return Error{error.what()};
}

Json ToJson(const Outcome& outcome) {
  Json json = {{"scenario", outcome.scenario},
               {"strategy", outcome.strategy},
               {"run", outcome.run},
               {"seed", outcome.seed},
               {"end", NameOf(outcome.end)},
               {"home_within_budget", outcome.end.ending.home_within_budget},
               {"stop_reason", ToText(outcome.end)},
               {"why", outcome.end.ending.why},
               {"distance_m", outcome.distance},
               {"duration_s", outcome.duration},
               {"motion", JsonOf(outcome.motion)},
               {"coverage", outcome.coverage},
               {"agreement", outcome.agreement},
               {"doubtful", outcome.doubtful},
               {"collisions", outcome.collisions},
               {"least_clearance_m", outcome.least_clearance},
               {"scans", outcome.scans},
               {"plans", outcome.plans},
               {"replans", outcome.replans},
               {"reversals", outcome.reversals},
               {"left_out", outcome.left_out}};
  Json& aside = json["set_aside"] = Json::array();
  for (const auto& count : outcome.set_aside) {
    aside.push_back({{"reason", NameOf(count.reason)},
                     {"doubtful", count.doubtful},
                     {"clusters", count.clusters},
                     {"voxels", count.voxels}});
  }
  Json& tight_ways = json["tight_ways"] = Json::array();
  for (const auto& [place_W, area] : outcome.end.ending.tight_ways)
    tight_ways.push_back({{"place", {place_W.x(), place_W.y(), place_W.z()}}, {"area_m2", area}});
  if (outcome.likeness) json["likeness"] = *outcome.likeness;
  if (outcome.own_pose) {
    const OwnPose::Figures& own = *outcome.own_pose;
    json["own_pose"] = {{"frames", own.frames}, {"degraded", own.degraded},
                        {"lost", own.lost},     {"losses", own.losses},
                        {"drift_m", own.drift}, {"greatest_drift_m", own.greatest_drift}};
  }
  if (outcome.tail) json["tail"] = JsonOf(*outcome.tail);
  if (outcome.surface) {
    json["surface"] = JsonOf(*outcome.surface);
    json["mesh_hash"] = outcome.mesh_hash;
  }
  if (outcome.optimum) json["optimum"] = ToJson(*outcome.optimum);
  Json& progress = json["progress"] = Json::array();
  for (const Outcome::Progress& at : outcome.progress) {
    progress.push_back({at.time, at.distance, at.coverage, at.p_W.x(), at.p_W.y(), at.p_W.z()});
  }
  Json& timings = json["timings_ms"] = Json::object();
  for (const auto& [stage, timing] : outcome.timings) {
    timings[stage] = {timing.count, timing.p50_ms, timing.p95_ms, timing.max_ms};
  }
  json["wall_s"] = outcome.wall;
  json["cpu_s"] = outcome.cpu;
  return json;
}

Result<Outcome> OutcomeFromJson(const nlohmann::json& json) try {
  Outcome outcome;
  json.at("scenario").get_to(outcome.scenario);
  json.at("strategy").get_to(outcome.strategy);
  json.at("run").get_to(outcome.run);
  json.at("seed").get_to(outcome.seed);
  const auto name = json.at("end").get<std::string>();
  const std::optional<RunEnd> end = RunEndNamed(name);
  if (!end) return Error{"end \"" + name + "\" is unknown"};
  outcome.end = *end;
  json.at("home_within_budget").get_to(outcome.end.ending.home_within_budget);
  json.at("why").get_to(outcome.end.ending.why);
  json.at("distance_m").get_to(outcome.distance);
  json.at("duration_s").get_to(outcome.duration);
  outcome.motion = MotionFrom(json.at("motion"));
  json.at("coverage").get_to(outcome.coverage);
  json.at("agreement").get_to(outcome.agreement);
  json.at("doubtful").get_to(outcome.doubtful);
  json.at("collisions").get_to(outcome.collisions);
  json.at("least_clearance_m").get_to(outcome.least_clearance);
  json.at("scans").get_to(outcome.scans);
  json.at("plans").get_to(outcome.plans);
  json.at("replans").get_to(outcome.replans);
  json.at("reversals").get_to(outcome.reversals);
  json.at("left_out").get_to(outcome.left_out);
  for (const auto& entry : json.at("set_aside")) {
    const auto why = entry.at("reason").get<std::string>();
    const auto aside = explorer::AsideReasonNamed(why);
    if (!aside) return Error{"set aside for the unknown reason \"" + why + "\""};
    outcome.set_aside.push_back({*aside, entry.at("doubtful"), entry.at("clusters"), entry.at("voxels")});
  }
  for (const auto& way : json.at("tight_ways")) {
    const auto place_W = way.at("place").get<std::array<double, 3>>();
    outcome.end.ending.tight_ways.push_back(
        {Eigen::Vector3d(place_W[0], place_W[1], place_W[2]), way.at("area_m2")});
  }
  if (json.contains("likeness")) outcome.likeness = json.at("likeness").get<double>();
  if (json.contains("own_pose")) {
    const auto& own = json.at("own_pose");
    outcome.own_pose = {.frames = own.at("frames"),
                        .degraded = own.at("degraded"),
                        .lost = own.at("lost"),
                        .losses = own.at("losses"),
                        .drift = own.at("drift_m"),
                        .greatest_drift = own.at("greatest_drift_m")};
  }
  if (json.contains("tail")) {
    const Result<Tail> tail = TailFrom(json.at("tail"));
    if (!tail) return Error{tail.error()};
    outcome.tail = *tail;
  }
  if (json.contains("surface")) {
    outcome.surface = SurfaceFrom(json.at("surface"));
    json.at("mesh_hash").get_to(outcome.mesh_hash);
  }
  if (json.contains("optimum")) {
    const Result<OfflineTours> tours = OfflineToursFromJson(json.at("optimum"));
    if (!tours) return Error{tours.error()};
    outcome.optimum = *tours;
  }
  for (const auto& at : json.at("progress")) {
    const auto numbers = at.get<std::array<double, 6>>();
    outcome.progress.push_back(
        {numbers[0], numbers[1], numbers[2], Eigen::Vector3d(numbers[3], numbers[4], numbers[5])});
  }
  for (const auto& [stage, timing] : json.at("timings_ms").items()) {
    outcome.timings[stage] = {timing.at(0), timing.at(1), timing.at(2), timing.at(3)};
  }
  json.at("wall_s").get_to(outcome.wall);
  json.at("cpu_s").get_to(outcome.cpu);
  return outcome;
} catch (const nlohmann::json::exception& error) {
  return Error{error.what()};
}

Json RowsOf(std::span<const Outcome> outcomes) {
  Json rows = Json::array();
  for (const Summary& summary : Summarize(outcomes)) {
    Json row = {{"scenario", summary.scenario},
                {"strategy", summary.strategy},
                {"runs", summary.runs},
                {"completed", summary.completed},
                {"path_mean", OrNull(summary.path.mean)},
                {"path_sd", OrNull(summary.path.deviation)},
                {"path_median", OrNull(summary.path.median)},
                {"path_ci95", {OrNull(summary.path.interval.low), OrNull(summary.path.interval.high)}}};
    for (const auto& [percent, path] : summary.path_to) {
      const std::string name = "path_p" + std::to_string(percent);
      row[name + "_mean"] = OrNull(path.mean);
      row[name + "_runs"] = path.count;
    }
    if (!summary.of_optimum.empty()) {
      Json& of_optimum = row["of_optimum"] = Json::object();
      for (const auto& [percent, of] : summary.of_optimum) of_optimum["p" + percent] = JsonOf(of);
    }
    if (summary.tail) row["tail"] = JsonOf(*summary.tail);
    if (summary.surface) row["surface_mean"] = JsonOf(*summary.surface);
    row["area_mean"] = OrNull(summary.area.mean);
    row["area_horizon_m"] = OrNull(summary.horizon);
    row["coverage_mean"] = OrNull(summary.coverage.mean);
    row["coverage_min"] = OrNull(summary.coverage.least);
    row["agreement_mean"] = OrNull(summary.agreement.mean);
    if (summary.likeness.count > 0) row["likeness_mean"] = summary.likeness.mean;
    Json& doubtful = row["doubtful_mean"] = Json::object();
    for (const auto& [log_odds, share] : summary.doubtful) doubtful[log_odds] = OrNull(share.mean);
    row["duration_mean_s"] = OrNull(summary.duration.mean);
    for (const auto& [percent, time] : summary.time_to)
      row["time_p" + std::to_string(percent) + "_mean_s"] = OrNull(time.mean);
    row["moving_mean_s"] = OrNull(summary.moving.mean);
    row["turning_mean_s"] = OrNull(summary.turning.mean);
    row["standing_mean_s"] = OrNull(summary.standing.mean);
    row["stops_mean"] = OrNull(summary.stops.mean);
    row["speed_mean_mps"] = OrNull(summary.speed.mean);
    row["most_speed_mps"] = summary.motion.most_speed;
    row["most_acceleration_mps2"] = summary.motion.most_acceleration;
    row["most_jerk_mps3"] = summary.motion.most_jerk;
    row["most_turn_rate_radps"] = summary.motion.most_turn_rate;
    row["most_turn_acceleration_radps2"] = summary.motion.most_turn_acceleration;
    row["scans_mean"] = OrNull(summary.scans.mean);
    row["reversals_mean"] = OrNull(summary.reversals.mean);
    row["replans_mean"] = OrNull(summary.replans.mean);
    row["collisions"] = summary.collisions;
    row["least_clearance_m"] = OrNull(summary.least_clearance);
    row["plan_ms_p50"] = OrNull(summary.plan().p50_ms);
    row["plan_ms_p95"] = OrNull(summary.plan().p95_ms);
    row["plan_ms_max"] = OrNull(summary.plan().max_ms);
    row["cpu_mean_s"] = OrNull(summary.cpu.mean);
    Json& stages = row["stages_ms"] = Json::object();
    for (const auto& [stage, time] : summary.stages) {
      stages[stage] = {{"p50", time.p50_ms}, {"p95", time.p95_ms}, {"max", time.max_ms}};
    }
    Json& aside = row["set_aside"] = Json::object();
    for (const auto& [reason, mean] : summary.set_aside) {
      aside[reason] = {{"clusters_mean", mean.clusters}, {"voxels_mean", mean.voxels}};
    }
    Json& reasons = row["stop_reasons"] = Json::object();
    for (const Summary::EndCount& count : summary.ends) reasons[ToText(count.end)] = count.runs;
    rows.push_back(std::move(row));
  }
  return rows;
}

Json ComparisonsOf(std::span<const Outcome> outcomes) {
  Json rows = Json::array();
  if (outcomes.empty()) return rows;
  for (const Comparison& comparison : Compare(outcomes, outcomes.front().strategy)) {
    rows.push_back({{"scenario", comparison.scenario.empty() ? "all" : comparison.scenario},
                    {"strategy", comparison.strategy},
                    {"against", comparison.against},
                    {"path_p95", JsonOf(comparison.to_95, comparison.decided_to_95)},
                    {"path", JsonOf(comparison.to_end, comparison.decided_to_end)}});
  }
  return rows;
}

Json EvaluationJson(std::span<const Outcome> outcomes, std::span<const std::string> overrides) {
  Json runs = Json::array();
  for (const Outcome& outcome : outcomes) runs.push_back(ToJson(outcome));
  return {{"overrides", std::vector<std::string>(overrides.begin(), overrides.end())},
          {"rows", RowsOf(outcomes)},
          {"comparisons", ComparisonsOf(outcomes)},
          {"runs", std::move(runs)}};
}

}  // namespace thalweg::evaluator
