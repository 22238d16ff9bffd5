#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/dds/topics.h"

namespace thalweg::recorder {

/// Follows the numbered updates of a topic as a reader of it does, so as to give others the full copy that
/// its publisher would give them.
///
/// Threading: one thread.
class UpdateFollower {
 public:
  using Sample = std::vector<std::uint8_t>;

  virtual ~UpdateFollower() = default;

  /// What does not decode, or does not follow what came before, is left out, as by any reader.
  /// @param token  As if the sample were Renamed with it.
  virtual void Follow(std::span<const std::uint8_t> sample, std::uint64_t token = 0) = 0;
  /// Everything so far, under the session and number of the last update; nothing before the first full copy.
  virtual std::optional<Sample> FullCopy() const = 0;
  /// A full copy without content, of a session of its own, which makes readers forget theirs. Takes header
  /// and voxel size from any sample of the topic; nothing if that does not decode.
  virtual std::optional<Sample> Nothing(std::span<const std::uint8_t> like, std::uint64_t session) const = 0;
  /// The sample under another session's number, see RenamedSession; as it is if it does not decode.
  virtual Sample Renamed(std::span<const std::uint8_t> sample, std::uint64_t token) const = 0;
};

/// Differs for different sessions and for different tokens; never 0. A token of 0 changes nothing.
constexpr std::uint64_t RenamedSession(std::uint64_t session, std::uint64_t token) {
  const std::uint64_t renamed = session ^ token;
  return renamed != 0 || token == 0 ? renamed : ~token;
}

/// For map/updates and surface/updates; null for any other topic.
std::unique_ptr<UpdateFollower> MakeUpdateFollower(std::string_view topic);

}  // namespace thalweg::recorder
