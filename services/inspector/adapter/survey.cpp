#include "services/inspector/adapter/survey.h"

#include <algorithm>

namespace thalweg::inspector {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using Steady = std::chrono::steady_clock;

// Participants answer an announcement at once, but the first packets may be lost. Those of thalweg repeat
// theirs every two seconds; others, and all their lists of writers and readers, every three.
constexpr Duration kCalm = 2500ms;
constexpr Duration kRepeated = 4s;
constexpr Duration kLongest = 8s;

/// Whether somebody is there, and something is known of everybody that is there.
bool IsComplete(const dds::BusGraph& graph) {
  const auto is_known = [&](const dds::Participant& participant) {
    return participant.is_discovery_server ||
           std::ranges::find(graph.endpoints, participant.id, &dds::Endpoint::participant) !=
               graph.endpoints.end();
  };
  return !graph.participants.empty() && std::ranges::all_of(graph.participants, is_known);
}

}  // namespace

dds::BusGraph Survey(dds::Bus& bus, const std::stop_token& stop) {
  std::size_t known = 0;
  Steady::time_point last_news = Steady::now();
  bus.EveryWall(50ms, [] {});  // so that the condition is looked at, since discovery wakes nobody
  bus.SpinUntil(
      [&] {
        const dds::BusGraph graph = bus.Graph();
        const std::size_t now_known = graph.participants.size() + graph.endpoints.size();
        if (now_known != known) last_news = Steady::now();
        known = now_known;
        const Duration patience = IsComplete(graph) ? kCalm : kRepeated;
        return stop.stop_requested() || Steady::now() - last_news > patience;
      },
      kLongest);
  return bus.Graph();
}

}  // namespace thalweg::inspector
