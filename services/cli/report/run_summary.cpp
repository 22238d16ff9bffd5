#include "services/cli/report/run_summary.h"

#include <fmt/format.h>

#include "services/cli/report/live_line.h"

namespace thalweg::cli {
namespace {

std::string CloudsText(std::uint64_t count, const char* what, const std::string& why) {
  return fmt::format("{} cloud{} {} ({})", count, count == 1 ? "" : "s", what, why);
}

}  // namespace

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
  if (record.clouds_not_mapped > 0) {
    summary += "; " + CloudsNotMappedText(record.clouds_not_mapped, record.clouds_not_mapped_why);
  }
  if (record.surface) {
    summary += fmt::format("; {:.1f} m2 of surface seen", record.surface->seen);
    if (record.surface->observable)
      summary += fmt::format(" of {:.1f} m2 that can be", *record.surface->observable);
    summary += fmt::format(", {:.1f} m2 of it inspected", record.surface->inspected);
    if (const std::uint64_t count = record.surface->clouds_not_fused; count > 0) {
      summary += "; " + CloudsText(count, "not in the surface", record.surface->clouds_not_fused_why);
    }
  }
  return summary;
}

std::string CloudsNotMappedText(std::uint64_t count, const std::string& why) {
  return CloudsText(count, "not mapped", why);
}

}  // namespace thalweg::cli
