#pragma once

#include <cstdint>

namespace thalweg::explorer {

/// The role of a cell in the field.
enum class FieldCell : std::uint8_t {
  kWall,    ///< Not part of the field: no flux through its faces. Everything outside the grid is a wall, too.
  kFree,    ///< phi is solved for.
  kSource,  ///< phi = +1: the robot.
  kSink,    ///< phi = -1: a frontier.
  kWeakSink,  ///< phi = -Options::weak_sink: a target worth less than a frontier.
};
inline bool IsSink(FieldCell cell) {
  return cell == FieldCell::kSink || cell == FieldCell::kWeakSink;
}

}  // namespace thalweg::explorer
