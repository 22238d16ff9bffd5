#include "services/inspector/adapter/survey.h"

namespace thalweg::inspector {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using Steady = std::chrono::steady_clock;

constexpr Duration kCalm = 1500ms;
// Participants answer an announcement at once, but the first packets may be lost. Everybody repeats its own
// within three seconds.
constexpr Duration kUntilAlone = 4s;
constexpr Duration kLongest = 6s;

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
        return stop.stop_requested() || Steady::now() - last_news > (known == 0 ? kUntilAlone : kCalm);
      },
      kLongest);
  return bus.Graph();
}

}  // namespace thalweg::inspector
