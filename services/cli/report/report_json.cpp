#include "services/cli/report/report_json.h"

#include <array>
#include <cstdio>

#include "services/cli/report/rounded.h"

namespace thalweg::cli {
namespace {

using Json = nlohmann::ordered_json;

Json TimingsToJson(const std::vector<StageTiming>& timings) {
  Json list = Json::array();
  for (const StageTiming& timing : timings) {
    list.push_back({{"name", timing.name},
                    {"count", timing.count},
                    {"p50_ms", Rounded(timing.p50_ms)},
                    {"p95_ms", Rounded(timing.p95_ms)},
                    {"max_ms", Rounded(timing.max_ms)}});
  }
  return list;
}

Json CountsToJson(const std::vector<MessageCount>& counts) {
  std::uint64_t total = 0;
  Json list = Json::array();
  for (const MessageCount& entry : counts) {
    total += entry.count;
    list.push_back(
        {{"service", entry.service}, {"name", entry.name}, {"count", entry.count}, {"last", entry.last}});
  }
  return {{"total", total}, {"by_topic", list}};
}

Json ProgressToJson(const std::vector<ProgressSample>& progress) {
  Json list = Json::array();
  for (const ProgressSample& sample : progress) {
    list.push_back({{"t_s", Rounded(sample.time)},
                    {"distance_m", Rounded(sample.distance)},
                    {"explored_m3", Rounded(sample.explored)},
                    {"coverage", Rounded(sample.coverage)}});
  }
  return list;
}

}  // namespace

Json ToJson(const RunRecord& record) {
  Json set_aside = Json::array();
  for (const FrontiersSetAside& entry : record.set_aside) {
    set_aside.push_back({{"reason", entry.reason}, {"clusters", entry.clusters}, {"voxels", entry.voxels}});
  }
  Json json;
  json["scenario"] = record.scenario;
  json["strategy"] = record.strategy;
  json["outcome"] = record.outcome ? Json(explorer::NameOf(*record.outcome)) : Json(nullptr);
  json["succeeded"] = record.succeeded;
  json["stop_reason"] = record.stop_reason;
  json["stop_details"] = record.stop_details;
  json["distance_m"] = Rounded(record.distance);
  json["duration_s"] = Rounded(record.duration);
  json["wall_s"] = Rounded(record.wall);
  json["explored_m3"] = Rounded(record.free_volume + record.occupied_volume);
  json["free_m3"] = Rounded(record.free_volume);
  json["occupied_m3"] = Rounded(record.occupied_volume);
  json["true_collisions"] = record.true_collisions ? Json(*record.true_collisions) : Json(nullptr);
  json["least_clearance_m"] = Rounded(record.least_clearance);
  json["agreement"] = Rounded(record.agreement);
  json["coverage"] = Rounded(record.coverage);
  if (record.surface) {
    json["surface"] = {{"seen_m2", Rounded(record.surface->seen)},
                       {"inspected_m2", Rounded(record.surface->inspected)},
                       {"observable_m2", Rounded(record.surface->observable)},
                       {"clouds_not_fused", record.surface->clouds_not_fused}};
  }
  json["frontiers_left"] = record.frontiers_left;
  json["frontiers_set_aside"] = std::move(set_aside);
  json["plans"] = record.plans;
  json["replans"] = record.replans;
  json["planning"] = TimingsToJson(record.planning);
  json["integration"] = TimingsToJson(record.integration);
  json["messages_rejected"] = CountsToJson(record.rejected);
  json["messages_dropped"] = CountsToJson(record.dropped);
  json["warnings"] = record.warnings;
  json["coverage_over"] = ProgressToJson(record.progress);
  return json;
}

}  // namespace thalweg::cli
