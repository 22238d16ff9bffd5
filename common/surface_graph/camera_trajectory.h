#pragma once

#include <functional>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "common/surface_graph/rift.h"

namespace thalweg::surface {

/// T_WC of a camera at p_W that looks along `forward_W`, upright: its image's horizontal axis is horizontal.
/// Where it looks straight up or down, that axis stays as near to the one before as it can.
/// @param forward_W  Unit length.
/// @param before     Pose before it.
RigidTransform LookingAlong(const Eigen::Vector3d& p_W, const Eigen::Vector3d& forward_W,
                            const RigidTransform& before);

/// A pose of the camera, and the point of the surface that it looks at.
struct CameraPose {
  RigidTransform T_WC;
  Eigen::Vector3d above_W;  ///< [m]
};

/// The camera's way along a path over the surface (Chapter 5 of the source thesis): a pose for each vertex,
/// at the constant height delta_h above the vertex along its normal, looking back along it. The last one
/// stands above the rift and looks along the rift's normal.
///
/// The thesis prints no rule for the roll (here: upright) nor for a vertex without a normal (here: left out).
/// As printed, nothing keeps the poses out of other surfaces.
/// @param path         Ends at the rift vertex.
/// @param camera_of    Position of the camera that saw a vertex.
/// @param rift_normal  Unit length, toward the side to look from.
/// @param height       [m] delta_h
/// @param before       T_WC before the first of these.
std::vector<CameraPose> CameraTrajectory(
    const SurfaceGraph& graph, const std::vector<SurfaceGraph::Vertex>& path,
    const std::function<Eigen::Vector3d(SurfaceGraph::Vertex)>& camera_of, const Eigen::Vector3d& rift_normal,
    double height, const RigidTransform& before);

/// Which of so many poses to take `views` from: evenly spaced, the last of all included; none if there are
/// none. Where there are fewer poses than views, one may be there several times.
std::vector<std::size_t> PlacesToLookFrom(std::size_t poses, int views);

/// The poses that PlacesToLookFrom names.
std::vector<CameraPose> PosesToLookFrom(const std::vector<CameraPose>& poses, int views);

}  // namespace thalweg::surface
