#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "common/base/time.h"

namespace thalweg::inspector {

/// How the last numbers of a series are spread.
struct Spread {
  std::size_t count = 0;
  double mean = 0.0;
  double min = 0.0;
  double max = 0.0;
  double deviation = 0.0;  ///< Standard deviation of the numbers themselves, as `ros2 topic hz` prints it.
};

/// The last `most` numbers of a series.
class Window {
 public:
  explicit Window(std::size_t most) : most_(most) {}  ///< most > 0
  void Add(double number);
  const std::deque<double>& numbers() const { return numbers_; }
  Spread Summarize() const;  ///< All 0 without numbers.

 private:
  std::size_t most_;
  std::deque<double> numbers_;
};

/// The rate at which messages arrive, and how regularly.
class RateMeter {
 public:
  explicit RateMeter(std::size_t most_messages) : periods_(most_messages) {}
  void Add(Time arrival);
  /// "average rate: 10.000" and the spread of the periods, as `ros2 topic hz` prints them; nothing before the
  /// second message.
  std::optional<std::string> Report() const;
  double hz() const;  ///< 0 before the second message.

 private:
  std::optional<Time> last_;
  Window periods_;  ///< [s]
};

/// Bytes per second, and the size of messages.
class BandwidthMeter {
 public:
  explicit BandwidthMeter(std::size_t most_messages) : periods_(most_messages), sizes_(most_messages) {}
  void Add(Time arrival, std::size_t bytes);
  std::optional<std::string> Report() const;  ///< As `ros2 topic bw` prints it.
  /// [B/s] Bytes of all messages of the window but its first, over the time since that one.
  double bytes_per_second() const;

 private:
  std::optional<Time> last_;
  Window periods_;  ///< [s]
  Window sizes_;    ///< [byte] Size of the message at the end of each period.
};

/// Notices when messages no longer arrive, by looks at their number once a second.
class ArrivalWatch {
 public:
  enum class Finding {
    kNew,     ///< Messages came since the last look.
    kNone,    ///< None did.
    kSilent,  ///< None did for kSilentLooks looks; once in a silence.
  };
  static constexpr int kSilentLooks = 3;
  /// @param received  Number of all messages so far.
  Finding Look(std::uint64_t received);

 private:
  std::uint64_t before_ = 0;
  int silent_ = 0;  ///< Looks without a new message.
};

/// The time from a message's stamp to its arrival.
class DelayMeter {
 public:
  explicit DelayMeter(std::size_t most_messages) : delays_(most_messages) {}
  void Add(Duration delay) { delays_.Add(Seconds(delay)); }
  std::optional<std::string> Report() const;  ///< As `ros2 topic delay` prints it.
  double median() const;                      ///< [s] 0 without messages.

 private:
  Window delays_;  ///< [s]
};

}  // namespace thalweg::inspector
