#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "services/gateway/core/session.h"

namespace thalweg::gateway {

/// The run so far, so that a page that is opened late or reloaded shows all of it: the path flown and the
/// curves. When it is full, every second row is removed and the interval between rows doubles.
class HistoryFeed final : public Feed {
 public:
  struct Row {
    Time stamp;
    float x, y, z;      ///< [m] Position of the body in map; NaN = unknown.
    float known_m3;     ///< [m^3]
    float distance_m;   ///< [m] Traveled so far, by odometry.
    float planning_ms;  ///< [ms] Median time of a plan so far; NaN = no plan yet.
  };
  static constexpr std::string_view kTopic = "thalweg/history";
  static constexpr std::string_view kSchemaName = "thalweg_msgs/msg/RunHistory";
  static constexpr std::string_view kSchema =
      "# The run so far, in rows; later messages append to it.\n"
      "bool reset             # forget all earlier rows\n"
      "float64[] time_s       # on the run's clock\n"
      "float32[] position_m   # x, y, z of each row, in map; NaN unknown\n"
      "float32[] known_m3     # volume of the known voxels\n"
      "float32[] distance_m   # traveled\n"
      "float32[] planning_ms  # median time of a plan; NaN before the first\n";
  static constexpr std::size_t kMaxRows = 8192;

  /// Adds a row if at least the current interval has passed since the last one. If its stamp is earlier than
  /// the last by a restart of the clock, or a jump back in a replay, rows that are later than it are
  /// forgotten.
  void Add(const Row& row);
  /// What comes next may not follow what came last: where time is missing in between, a row without a
  /// position interrupts the path.
  void Interrupt() { interrupted_ = true; }
  std::optional<Message> Next(std::uint64_t& cursor) const override;

  std::size_t row_count() const { return rows_.size(); }

 private:
  std::vector<Row> rows_;
  Duration interval_ = std::chrono::milliseconds(250);
  bool interrupted_ = false;
  std::uint64_t generation_ = 1;  ///< Changes when earlier rows change. Upper half of a cursor.
};

}  // namespace thalweg::gateway
