#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "common/base/time.h"

namespace thalweg::gateway {

/// Limits what others can make a log grow by: a few lines at once, and then one a second.
class LogBudget {
 public:
  static constexpr double kAtOnce = 20.0;

  /// @param now  On any clock that never goes back.
  /// @return How many lines were left out before this one; nothing if this one is to be left out, too.
  std::optional<std::uint64_t> Spend(Duration now) {
    allowance_ = std::min(kAtOnce, allowance_ + Seconds(std::max(now - at_, Duration::zero())));
    at_ = now;
    if (allowance_ < 1.0) {
      ++left_out_;
      return std::nullopt;
    }
    allowance_ -= 1.0;
    return std::exchange(left_out_, 0);
  }

 private:
  double allowance_ = kAtOnce;
  Duration at_ = {};
  std::uint64_t left_out_ = 0;
};

}  // namespace thalweg::gateway
