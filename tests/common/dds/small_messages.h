#pragma once

#include <cstdint>
#include <string>

#include "common/dds/bus.h"

namespace thalweg::test {

inline thalweg_msgs::msg::MotionStatus Saying(const std::string& reason) {
  thalweg_msgs::msg::MotionStatus status;
  status.reason(reason);
  return status;
}

inline thalweg_msgs::msg::MapUpdate Numbered(std::uint64_t number) {
  thalweg_msgs::msg::MapUpdate update;
  update.number(number);
  return update;
}

}  // namespace thalweg::test
