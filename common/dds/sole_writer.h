#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <vector>

#include "common/base/time.h"

namespace thalweg::dds {

/// Keeps a reader to one writer of a topic that has only one: a second one, by mistake or by intent, would
/// mix its samples with those of the first.
///
/// The reader follows the one that it heard first of the writers that exist and are not silent; one that was
/// heard alone for a while goes before one that was not. So another takes over when the first falls silent or
/// is gone, and the first is followed again as soon as it speaks. Where commands are at stake, nobody is
/// followed while two speak of whom neither was heard alone: the reader cannot know which is genuine.
///
/// Silence is counted only while the reader was attentive: after a stall of its own, what the first writer
/// sent still waits to be read.
///
/// Threading: one thread.
template <class Id>
class SoleWriter {
 public:
  using SteadyTime = std::chrono::steady_clock::time_point;
  enum class Verdict {
    kFollow,
    kRefuse,     ///< rival() is followed.
    kContested,  ///< Neither the writer nor rival() is followed.
  };
  /// A reader that looks less often than this was not attentive in between.
  static constexpr Duration kAttentive = std::chrono::milliseconds(300);
  /// For how long a writer has to be heard alone until it is known.
  static constexpr Duration kAcquaintance = std::chrono::seconds(3);

  /// A writer that sends nothing for `silence` may be replaced by another.
  /// @param for_commands  Whether to follow nobody in case of doubt.
  SoleWriter(Duration silence, bool for_commands) : silence_(silence), for_commands_(for_commands) {}

  /// Whether a sample that `writer` sent is to be used.
  /// @param is_matched  Whether a writer still exists.
  Verdict Judge(const Id& writer, const std::function<bool(const Id&)>& is_matched) {
    std::erase_if(heard_, [&](const Heard& other) { return other.id != writer && !is_matched(other.id); });
    auto own = std::ranges::find(heard_, writer, &Heard::id);
    if (own == heard_.end()) {
      heard_.push_back({.id = writer, .alone_since = attentive_, .last = attentive_, .known = false});
      own = std::prev(heard_.end());
    }
    own->last = attentive_;
    const auto rival = FindRival(own);
    if (rival == heard_.end()) {
      own->known = own->known || attentive_ - own->alone_since >= kAcquaintance;
      return Verdict::kFollow;
    }
    rival_ = rival->id;
    own->alone_since = attentive_;
    if (!for_commands_ || rival->known) return Verdict::kRefuse;
    rival->alone_since = attentive_;
    return Verdict::kContested;
  }

  /// The reader holds no sample at `now`: whoever sent nothing until now is silent.
  void SawNothing(SteadyTime now) {
    if (looked_) attentive_ += std::clamp<Duration>(now - *looked_, Duration::zero(), kAttentive);
    looked_ = now;
  }

  /// The writer because of which the last sample that was not used was refused.
  const Id& rival() const { return rival_; }

 private:
  /// Times are of the reader's attention.
  struct Heard {
    Id id;
    Duration alone_since;
    Duration last;
    bool known;
  };
  using Iterator = typename std::vector<Heard>::iterator;

  /// Another writer that is not silent, and either is to be followed rather than `own`, or makes it doubtful
  /// which of the two is.
  Iterator FindRival(Iterator own) {
    for (auto other = heard_.begin(); other != heard_.end(); ++other) {
      if (other == own || attentive_ - other->last > silence_) continue;
      const bool is_doubtful = for_commands_ && !own->known && !other->known;
      const bool comes_first = own->known == other->known ? other < own : other->known;
      if (is_doubtful || comes_first) return other;
    }
    return heard_.end();
  }

  Duration silence_;
  bool for_commands_;
  std::vector<Heard> heard_;  ///< In the order in which they were heard first.
  Duration attentive_{};
  std::optional<SteadyTime> looked_;
  Id rival_{};
};

}  // namespace thalweg::dds
