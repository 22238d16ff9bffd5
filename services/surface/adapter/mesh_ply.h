#pragma once

#include <string>

#include "services/surface/core/fused/surface_mesh.h"

namespace thalweg::surface {

/// A mesh as a binary little-endian PLY as MeshLab, Blender and CloudCompare read it: vertices with x, y, z
/// [m] in W and nx, ny, nz as float32, red, green and blue as uint8; faces as lists of vertex_indices.
std::string PlyOf(const TriangleMesh& mesh);

}  // namespace thalweg::surface
