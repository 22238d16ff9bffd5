#pragma once

#include <optional>

#include "common/surface_graph/rift.h"

namespace thalweg::surface {

/// PlanePCA: the normal of the plane through a vertex and its neighbors within one edge, which is the right
/// singular vector of their mean-centered positions that belongs to the smallest singular value.
///
/// It is computed as the eigenvector of the 3 x 3 scatter matrix, which is the same. The thesis states no
/// sign; here the normal faces the camera that saw the vertex.
/// @param camera_W  [m] Position of that camera.
/// @return  Unit length; nothing if the points do not span a plane.
std::optional<Eigen::Vector3d> PlaneNormal(const SurfaceGraph& graph, SurfaceGraph::Vertex vertex,
                                           const Eigen::Vector3d& camera_W);

/// The same for a rift vertex, whose neighbors are the rift's vertices.
///
/// An edge between a nearer and a farther surface lies along the line of sight, and so do the plane of a
/// straight rift and the camera: on which side of the plane the camera is is then chance. The open side is
/// where, in the image, the farther ends of the edges are beside the nearer ones. Of the two hints the
/// clearer one decides.
std::optional<Eigen::Vector3d> RiftNormal(const SurfaceGraph& graph, const Rift& rift,
                                          const Eigen::Vector3d& camera_W);

}  // namespace thalweg::surface
