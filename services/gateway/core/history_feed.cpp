#include "services/gateway/core/history_feed.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "services/gateway/core/cdr_writer.h"

namespace thalweg::gateway {
namespace {

constexpr int kGenerationShift = 32;
constexpr Duration kGap = std::chrono::seconds(1);

}  // namespace

void HistoryFeed::Add(const Row& row) {
  if (!rows_.empty() && row.stamp + kClockRestart < rows_.back().stamp) {
    std::erase_if(rows_, [&](const Row& each) { return each.stamp > row.stamp; });
    ++generation_;
  }
  if (!rows_.empty() && row.stamp < rows_.back().stamp + interval_) return;
  if (rows_.size() + 1 >= kMaxRows) {
    std::vector<Row> half;
    for (std::size_t n = 0; n < rows_.size(); n += 2) half.push_back(rows_[n]);
    rows_ = std::move(half);
    interval_ *= 2;
    ++generation_;
  }
  const bool gap = !rows_.empty() && row.stamp > rows_.back().stamp + std::max<Duration>(kGap, 2 * interval_);
  if (std::exchange(interrupted_, false) && gap) {
    rows_.push_back(row);
    rows_.back().x = rows_.back().y = rows_.back().z = std::numeric_limits<float>::quiet_NaN();
  }
  rows_.push_back(row);
}

std::optional<Feed::Message> HistoryFeed::Next(std::uint64_t& cursor) const {
  const bool reset = cursor >> kGenerationShift != generation_;
  const std::size_t first = reset ? 0 : static_cast<std::size_t>(cursor & 0xffffffffU);
  if (rows_.empty() || first >= rows_.size()) return std::nullopt;
  cursor = generation_ << kGenerationShift | rows_.size();
  std::vector<double> time;
  std::vector<float> position;
  std::vector<float> known;
  std::vector<float> distance;
  std::vector<float> planning;
  for (std::size_t n = first; n < rows_.size(); ++n) {
    const Row& row = rows_[n];
    time.push_back(Seconds(row.stamp.time_since_epoch()));
    position.insert(position.end(), {row.x, row.y, row.z});
    known.push_back(row.known_m3);
    distance.push_back(row.distance_m);
    planning.push_back(row.planning_ms);
  }
  CdrWriter cdr;
  cdr.Put(static_cast<std::uint8_t>(reset));
  cdr.PutSequence(time);
  cdr.PutSequence(position);
  cdr.PutSequence(known);
  cdr.PutSequence(distance);
  cdr.PutSequence(planning);
  return Message{rows_.back().stamp, std::make_shared<const std::vector<std::uint8_t>>(cdr.Take())};
}

}  // namespace thalweg::gateway
