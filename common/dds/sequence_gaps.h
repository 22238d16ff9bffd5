#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thalweg::dds {

/// Counts the samples that a reader missed: each writer numbers its samples without gaps [RTPS 2.3, section
/// 8.7.3], so that a sample that was lost on the way, or replaced before it was read, leaves one. It is
/// noticed at the writer's next sample. Remembers the writers that it heard last, of which there are few.
///
/// Threading: one thread.
template <class Id>
class SequenceGaps {
 public:
  static constexpr std::size_t kRemembered = 256;

  /// The number of samples that `writer` sent between the last one of it that was read and this one. Nothing
  /// is known of what it sent before the first.
  std::uint64_t Missed(const Id& writer, std::uint64_t number) {
    const auto known = std::ranges::find(heard_, writer, &Heard::writer);
    if (known == heard_.end()) {
      if (heard_.size() == kRemembered) heard_.erase(heard_.begin());
      heard_.push_back({writer, number});
      return 0;
    }
    const std::uint64_t last = known->number;
    known->number = std::max(last, number);  // a writer's state comes again when a reader is opened again
    std::rotate(known, known + 1, heard_.end());
    return number > last ? number - last - 1 : 0;
  }

 private:
  struct Heard {
    Id writer;
    std::uint64_t number;
  };
  std::vector<Heard> heard_;  ///< The one heard last at the end.
};

}  // namespace thalweg::dds
