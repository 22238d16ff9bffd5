#include "services/cli/report/run_summary.h"

#include <fmt/format.h>

#include "services/cli/report/live_line.h"

namespace thalweg::cli {

std::string SummaryText(const RunRecord& record, bool simulated) {
  std::string summary =
      fmt::format("{}: {:.1f} m in {}{}, {} wall clock; {:.1f} m3 explored", record.stop_reason,
                  record.distance, ClockText(record.duration), simulated ? " simulated" : "",
                  ClockText(record.wall), record.free_volume + record.occupied_volume);
  if (record.coverage && record.agreement) {
    summary += fmt::format("; coverage {:.1f} %, agreement {:.1f} %", 100.0 * *record.coverage,
                           100.0 * *record.agreement);
  }
  if (record.true_collisions) summary += fmt::format("; {} collisions", *record.true_collisions);
  return summary;
}

}  // namespace thalweg::cli
