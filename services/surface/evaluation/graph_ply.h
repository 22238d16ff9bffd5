#pragma once

#include <string>

#include "common/surface_graph/surface.h"

namespace thalweg::surface {

// Binary little-endian PLY as MeshLab reads it: vertices with x, y, z as float32 [m] in W and red, green,
// blue as uint8.

/// The graph: also edges with vertex1 and vertex2 as int32 and their own colors, from green to red by weight.
/// With the rift vertices that it contains at present, as the last vertices and edges.
std::string GraphPly(const Surface& surface);

/// The surface: also faces, two triangles for each cell, facing the camera that saw them.
std::string MeshPly(const Surface& surface);

}  // namespace thalweg::surface
