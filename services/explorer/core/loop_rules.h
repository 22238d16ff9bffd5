#pragma once

#include <cstdint>

namespace thalweg::explorer {

/// What the loop around every strategy does beyond the one that the source thesis prints: scan, map, choose,
/// move to the end, again, until no frontier is left. With all of them off it is that loop
/// [docs/decisions/0042]. A strategy that goes by views is not subject to looking around, setting aside,
/// stopping short, keeping off, waiting at shut ways and going tight ways.
struct LoopRules {
  enum class Set : std::uint8_t { kOurs, kPrinted };
  static constexpr LoopRules Of(Set set);

  Set set = Set::kOurs;  ///< What the others began as.
  /// Turns to unknown space in sight before going anywhere, but for what Strategy::weighs_looks leaves out.
  bool look_around = true;
  bool scan_on_the_way = true;  ///< Scans while moving count, and end a plan whose target has been seen.
  bool drop_small = true;       ///< Ignores frontiers below the least area.
  bool set_aside = true;        ///< Gives up what looking does not resolve. An operator's word always counts.
  bool stop_short = true;       ///< Stops where half of what the path's end would show is in sight.
  bool keep_off = true;         ///< Leads paths away from what is near, where there is room.
  bool pull_straight = true;    ///< Straightens paths.
  /// Faces what is to be seen, and where to go in narrow passages; off: the direction of travel, except at
  /// the end of a path to where a strategy takes a view.
  bool face_target = true;
  bool wait_at_shut_ways = true;  ///< Watches a way that was open and is shut before the end.
  /// Before the end, goes through gaps that are wide enough, but have no voxel's center in their middle, and
  /// back through those by which it came, also on its way home.
  bool go_tight_ways = true;
};

constexpr LoopRules LoopRules::Of(Set set) {
  const bool on = set == Set::kOurs;
  return {.set = set,
          .look_around = on,
          .scan_on_the_way = on,
          .drop_small = on,
          .set_aside = on,
          .stop_short = on,
          .keep_off = on,
          .pull_straight = on,
          .face_target = on,
          .wait_at_shut_ways = on,
          .go_tight_ways = on};
}

}  // namespace thalweg::explorer
