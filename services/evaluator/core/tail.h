#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "services/explorer/core/explorer.h"

namespace thalweg::evaluator {

inline constexpr double kTailCoverage = 0.95;
inline constexpr double kLongJourney = 2.0;      ///< [m]
inline constexpr std::size_t kSmallTarget = 20;  ///< [voxels]

/// The part of a run's path that follows kTailCoverage, journey by journey.
struct Tail {
  /// What a journey was for.
  enum class Kind : std::uint8_t {
    kPassedBy,  ///< The target was known nearby before, and was left.
    kNew,       ///< It had never been known nearby.
    kInVain,    ///< Nothing of it became known.
    kAtHand,    ///< It had been known nearby and not been left yet.
  };
  static constexpr Kind kKinds[] = {Kind::kPassedBy, Kind::kNew, Kind::kInVain, Kind::kAtHand};

  /// The path toward one target: from the plan to go to it to the next plan for another.
  struct Journey {
    double length = 0.0;     ///< [m] After kTailCoverage.
    std::size_t voxels = 0;  ///< Size of the target when it was chosen.
    Kind kind = Kind::kNew;
    bool was_in_sight = false;  ///< Nearby, before the journey: a turn would have shown it.
    bool operator==(const Journey&) const = default;
  };
  std::optional<double> begins;   ///< [m] Path at which kTailCoverage was reached; empty if it never was.
  std::vector<Journey> journeys;  ///< Those with a length, in order.
  double other = 0.0;             ///< [m] Traveled in the tail for other reasons, as to go home.

  double length() const;  ///< [m] Length of the whole tail.
  bool operator==(const Tail&) const = default;
};
/// The name under which files keep it, which no rewording changes: "passed by", ...
std::string_view NameOf(Tail::Kind kind);
std::optional<Tail::Kind> TailKindNamed(std::string_view name);

/// Follows a run and records its tail.
///
/// "Known nearby" is an unknown voxel next to free space at most 2 m from the robot, with or without a wall
/// between them, and whatever is at most two voxels beside it along each axis, since the border of the
/// unknown moves as pockets are seen in part; it was in sight if there are but free voxels of the robot's map
/// between them, too. It was left when the robot then traveled 3 m or more before it was nearby again, or
/// before the journey to it began. A journey counts as passed by when that is so for at least half of the
/// target's voxels, else as at hand when at least half have been nearby, else as new; as in vain, whatever
/// else, when none of them became known before the next journey. Threading: one thread.
class TailRecorder {
 public:
  static constexpr double kNear = 2.0;   ///< [m]
  static constexpr double kLeave = 3.0;  ///< [m]

  /// After each scan, when it is in the map.
  /// @param distance  [m] Traveled so far.
  /// @param coverage  Known share of what is observable.
  void OnScan(double distance, double coverage, const Eigen::Vector3d& p_W, const explorer::PlanningMap& map);
  /// When a plan is made, from the place of the last scan.
  /// @param target  The voxels that it is to show.
  void OnPlan(const explorer::Plan& plan, std::span<const VoxelIndex> target);
  /// Ends the record. @param distance  [m] Traveled in the whole run.
  Tail Finish(double distance);

 private:
  struct Nearby {
    double last = 0.0;  ///< [m] Path at which it was last known nearby.
    bool left = false;
    bool in_sight = false;  ///< At any time.
  };
  struct Open {
    double begins = 0.0;                 ///< [m]
    std::vector<VoxelIndex> target;      ///< Empty: the path has no target.
    Tail::Kind kind = Tail::Kind::kNew;  ///< Unless it was in vain.
    bool was_in_sight = false;
    bool in_vain = true;  ///< So far.
  };
  /// Sets what a journey to the target is for.
  void Classify(std::span<const VoxelIndex> target, Open& journey) const;
  void Close();

  Tail tail_;
  Open open_;
  double distance_ = 0.0;  ///< [m] At the last scan.
  std::unordered_map<VoxelIndex, Nearby, VoxelIndexHash> nearby_;
};

}  // namespace thalweg::evaluator
