#include "services/cli/report/decision_log.h"

namespace thalweg::cli {

void DecisionLog::OnStatus(const Status& status) {
  if (status.plans < plans_) {
    plans_before_ += plans_;
    plans_ = 0;
    abandoned_ = 0;
  }
  // A decision that is abandoned is the one before those that this status reports.
  if (status.abandoned > abandoned_ && !decisions_.empty()) {
    decisions_.back().interruption = status.last_interruption;
  }
  abandoned_ = status.abandoned;
  if (status.plans == plans_) return;
  plans_ = status.plans;
  decided_before_ = decisions_.empty() ? Time{} : decided_at_;
  decided_at_ = status.stamp;
  decisions_.push_back({.number = plans_before_ + plans_,
                        .time = status.time,
                        .purpose = status.activity,
                        .target_W = status.target_W,
                        .length = std::nullopt,
                        .interruption = {}});
  if (decisions_.size() > kMost) {
    decisions_.pop_front();
    ++forgotten_;
  }
  AddLength();
}

void DecisionLog::OnPath(Time stamp, double length) {
  path_ = {stamp, length};
  AddLength();
}

void DecisionLog::AddLength() {
  if (!path_ || decisions_.empty() || decisions_.back().length) return;
  // The plan was made before its status was published and after the previous one's.
  if (path_->first > decided_at_ || path_->first <= decided_before_) return;
  decisions_.back().length = path_->second;
}

}  // namespace thalweg::cli
