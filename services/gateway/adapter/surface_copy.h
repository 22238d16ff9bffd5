#pragma once

#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/dds/topics.h"
#include "services/gateway/core/surface_feed.h"

namespace thalweg::gateway {

/// Follows the numbered updates of the surface's mesh, and says when one is missing. The mesh itself is the
/// receiver's.
///
/// Threading: one thread.
class SurfaceCopy {
 public:
  static constexpr std::size_t kMostBlocks = 1U << 20U;  ///< In one update; a larger one is refused.

  /// @return What changes; nothing if the update is old, or leaves a gap: then missing() is true. Error: what
  /// is
  ///   wrong with the message.
  Result<std::optional<SurfaceChange>> Apply(const thalweg_msgs::msg::SurfaceUpdate& update);

  bool missing() const { return !complete_; }  ///< Whether a full copy must be requested.
  /// @param reader  Name of the service that asks.
  thalweg_msgs::msg::MapRequest MakeRequest(Time now, const std::string& reader) const;

 private:
  bool complete_ = false;
  std::uint64_t session_ = 0;
  std::uint64_t number_ = 0;
};

}  // namespace thalweg::gateway
