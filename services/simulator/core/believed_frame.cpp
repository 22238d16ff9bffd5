#include "services/simulator/core/believed_frame.h"

#include <algorithm>

namespace thalweg::simulator {
namespace {

constexpr Duration kMemory = std::chrono::seconds(2);

}  // namespace

void BelievedFrame::Note(Time stamp, const RigidTransform& T_WB_true) {
  moments_.push_back({stamp, T_WB_true});
  while (stamp - moments_.front().stamp > kMemory) moments_.pop_front();
}

void BelievedFrame::Believe(Time stamp, const RigidTransform& T_WB) {
  const auto at = std::lower_bound(moments_.begin(), moments_.end(), stamp,
                                   [](const Moment& moment, Time time) { return moment.stamp < time; });
  if (at == moments_.end() || at->stamp != stamp) return;
  T_true_believed_ = at->T_WB_true * T_WB.inverse();
}

}  // namespace thalweg::simulator
