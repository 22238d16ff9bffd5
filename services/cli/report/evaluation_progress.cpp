#include "services/cli/report/evaluation_progress.h"

#include <fmt/format.h>

#include "services/cli/report/live_line.h"
#include "services/evaluator/core/summary.h"
#include "services/evaluator/text/run_end_text.h"

namespace thalweg::cli {

std::string ProgressBar::Beginning() const {
  return resumed_ > 0 ? fmt::format("{} of {} runs were made before\n", resumed_, total_) : "";
}

std::string ProgressBar::After(const evaluator::Outcome& outcome, std::size_t made, double wall) const {
  const double left = wall * static_cast<double>(total_ - made) / static_cast<double>(made - resumed_);
  constexpr std::size_t kWidth = 30;
  const std::string bar(kWidth * made / total_, '=');
  return fmt::format("{}[{:<{}}] {}/{}, {} left  {} {} start {}: {}, {:.1f} m, coverage {:.1f} %{}",
                     terminal_ ? "\r\33[K" : "", bar, kWidth, made, total_, ClockText(left), outcome.scenario,
                     outcome.strategy, outcome.seed, ToText(outcome.end), outcome.distance,
                     100.0 * outcome.coverage, terminal_ && made < total_ ? "" : "\n");
}

std::string TourText(const evaluator::Outcome& outcome, bool from_cache) {
  const evaluator::OfflineTours& tours = *outcome.optimum;
  std::string text = fmt::format("{} start {}: ", outcome.scenario, outcome.seed);
  if (tours.places == 0) {
    text += "no room for a tour at the start";
  } else {
    for (std::size_t k = 0; k < tours.to.size(); ++k) {
      const evaluator::OfflineTour& tour = tours.to.at(k);
      text += fmt::format("{} {} m to {} %", k == 0 ? "offline tours" : ",",
                          tour.length ? fmt::format("{:.1f}", *tour.length) : "-",
                          evaluator::PercentText(evaluator::kTourCoverages.at(k)));
    }
  }
  if (tours.out_of_time) text += fmt::format("; out of time after {} iterations", tours.iterations);
  return text + (from_cache ? " (found before)" : "");
}

}  // namespace thalweg::cli
