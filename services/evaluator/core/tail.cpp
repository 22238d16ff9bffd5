#include "services/evaluator/core/tail.h"

#include <algorithm>

#include "common/voxel/for_each_voxel.h"
#include "services/explorer/core/map/frontier.h"

namespace thalweg::evaluator {
namespace {

constexpr int kBeside = 2;  // [voxels] at which a voxel belongs to the same pocket

}  // namespace

double Tail::length() const {
  double length = other;
  for (const Journey& journey : journeys) length += journey.length;
  return length;
}

std::string_view NameOf(Tail::Kind kind) {
  switch (kind) {
    case Tail::Kind::kPassedBy:
      return "passed by";
    case Tail::Kind::kNew:
      return "new";
    case Tail::Kind::kInVain:
      return "in vain";
    case Tail::Kind::kAtHand:
      return "at hand";
  }
  return "";
}

std::optional<Tail::Kind> TailKindNamed(std::string_view name) {
  for (const Tail::Kind kind : Tail::kKinds) {
    if (NameOf(kind) == name) return kind;
  }
  return std::nullopt;
}

void TailRecorder::OnScan(double distance, double coverage, const Eigen::Vector3d& p_W,
                          const explorer::PlanningMap& map) {
  distance_ = distance;
  if (!tail_.begins && coverage >= kTailCoverage) tail_.begins = distance;
  open_.in_vain = open_.in_vain && std::ranges::all_of(open_.target, [&](const VoxelIndex& i) {
                    return map.State(i) == VoxelState::kUnknown;
                  });
  const Eigen::Vector3d eye_W = map.EyeAt(p_W);
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(kNear);
  const VoxelBox around{map.IndexOf(eye_W - reach), map.IndexOf(eye_W + reach) + VoxelIndex{1, 1, 1}};
  ForEachVoxel(Intersection(around, map.box()), [&](const VoxelIndex& i) {
    if (map.states()[i] != VoxelState::kUnknown || !explorer::IsTarget(map, i)) return;
    const Eigen::Vector3d center_W = map.CenterOf(i);
    if ((center_W - eye_W).squaredNorm() > kNear * kNear) return;
    const auto [entry, is_new] = nearby_.try_emplace(i, Nearby{.last = distance});
    Nearby& nearby = entry->second;
    if (!is_new && distance - nearby.last >= kLeave) nearby.left = true;
    nearby.last = distance;
    nearby.in_sight = nearby.in_sight || map.InSight(eye_W, center_W);
  });
}

void TailRecorder::Classify(std::span<const VoxelIndex> target, Open& journey) const {
  std::size_t left = 0;
  std::size_t near = 0;
  std::size_t in_sight = 0;
  for (const VoxelIndex& voxel : target) {
    std::optional<Nearby> nearby;
    ForEachVoxel(CubeAround(voxel, kBeside), [&](const VoxelIndex& i) {
      const auto found = nearby_.find(i);
      if (found == nearby_.end()) return;
      if (!nearby) nearby = found->second;
      nearby->last = std::max(nearby->last, found->second.last);
      nearby->left = nearby->left || found->second.left;
      nearby->in_sight = nearby->in_sight || found->second.in_sight;
    });
    if (!nearby) continue;
    ++near;
    if (nearby->left || distance_ - nearby->last >= kLeave) ++left;
    if (nearby->in_sight) ++in_sight;
  }
  journey.kind = 2 * left >= target.size()   ? Tail::Kind::kPassedBy
                 : 2 * near >= target.size() ? Tail::Kind::kAtHand
                                             : Tail::Kind::kNew;
  journey.was_in_sight = 2 * in_sight >= target.size();
}

void TailRecorder::OnPlan(const explorer::Plan& plan, std::span<const VoxelIndex> target) {
  if (plan.kind == explorer::Plan::Kind::kLook) return;  // it goes nowhere
  const bool has_target = plan.purpose == explorer::Purpose::kSeeFrontier && !target.empty();
  if (has_target && std::ranges::equal(target, open_.target)) return;  // on after an interruption
  Close();
  open_ = {.begins = distance_, .target = {}};
  if (!has_target) return;
  open_.target.assign(target.begin(), target.end());
  Classify(target, open_);
}

void TailRecorder::Close() {
  if (!tail_.begins) return;
  const double length = distance_ - std::max(open_.begins, *tail_.begins);
  if (!(length > 0.0)) return;
  if (open_.target.empty()) {
    tail_.other += length;
    return;
  }
  tail_.journeys.push_back({.length = length,
                            .voxels = open_.target.size(),
                            .kind = open_.in_vain ? Tail::Kind::kInVain : open_.kind,
                            .was_in_sight = open_.was_in_sight});
}

Tail TailRecorder::Finish(double distance) {
  distance_ = distance;
  Close();
  return std::move(tail_);
}

}  // namespace thalweg::evaluator
