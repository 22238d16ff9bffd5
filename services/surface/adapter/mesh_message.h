#pragma once

#include "common/dds/topics.h"
#include "services/surface/core/fused/surface_mesh.h"

namespace thalweg::surface {

/// The mesh of a block as a message. @param mesh  nullptr: the block has none any more.
thalweg_msgs::msg::SurfaceBlock ToIdl(const VoxelIndex& block, const BlockMesh* mesh,
                                      const InspectionLimits& limits);

}  // namespace thalweg::surface
