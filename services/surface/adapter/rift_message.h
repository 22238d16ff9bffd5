#pragma once

#include "common/dds/topics.h"
#include "services/surface/core/fused/mesh_rifts.h"

namespace thalweg::surface {

inline constexpr std::size_t kMostOpenRifts = 256;  ///< In a message: the first ones.

/// The rifts as a message, without its header and session.
thalweg_msgs::msg::SurfaceRifts ToIdl(const MeshRifts& rifts);

/// The same open rifts for tools that know no type of ours: of each its line, its normal and its number at
/// the center; red the heaviest, orange those that a path leads to, gray the others. Replaces all markers
/// before.
visualization_msgs::msg::MarkerArray MarkersOf(const MeshRifts& rifts, const std_msgs::msg::Header& header);

}  // namespace thalweg::surface
