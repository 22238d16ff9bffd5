#pragma once

#include <opencv2/core.hpp>

#include "services/surface/core/fused/surface_mesh.h"

namespace thalweg::surface {

/// The mesh in its colors, seen from above and from a side, as large as it fits: 8 bit, blue, green, red.
/// What faces away from the viewer is left out, so that one looks over the nearest walls and through the
/// ceiling into rooms. Faces are the darker the more obliquely they are seen. White if the mesh is empty.
///
/// Parallel projection onto a plane, with a depth buffer; colors are interpolated between vertices.
cv::Mat DrawMesh(const TriangleMesh& mesh);

}  // namespace thalweg::surface
