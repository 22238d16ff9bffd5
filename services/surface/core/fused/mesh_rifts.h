#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/geometry/depth_error.h"
#include "services/surface/core/fused/mesh_border.h"
#include "services/surface/core/fused/mesh_patches.h"

namespace thalweg::surface {

/// Where a fused surface is torn: a closed line of its border, or several that touch.
struct MeshRift {
  enum class Fate : std::uint8_t {
    kOpen,
    kMerged,  ///< Has become part of another one.
    kClosed,  ///< Is there no more, or what is left is less than the sensor resolves.
  };
  static constexpr double kNoPath = std::numeric_limits<double>::infinity();

  std::uint32_t number = 0;  ///< From 1; stays as long as the rift lasts.
  Fate fate = Fate::kOpen;
  std::uint32_t merged_into = 0;                       ///< Number of the other one, if merged.
  Eigen::Vector3f center_W = Eigen::Vector3f::Zero();  ///< Mean of the vertices on the line.
  /// The vertex on the line by which the shortest path leads to the center; without one, that nearest to it.
  Eigen::Vector3f nearest_W = Eigen::Vector3f::Zero();
  /// Mean of the vertices' normals, unit length; zero if they cancel each other out.
  Eigen::Vector3f normal_W = Eigen::Vector3f::Zero();
  double length = 0.0;                                      ///< [m] The line's.
  std::uint32_t edges = 0;                                  ///< On the line.
  double distance = kNoPath;                                ///< [m] Over the surface, see MeshRifts::Find.
  double weight = 0.0;                                      ///< 0 without a path.
  std::vector<std::array<Eigen::Vector3f, 2>> line_W = {};  ///< The ends of each edge; empty unless open.

  bool operator==(const MeshRift&) const = default;
};

/// The rifts of a fused surface, with an identity that lasts.
///
/// What Algorithm 2 and Eq. (5.11) of the source thesis find in a graph of pixels (../rift.h,
/// ../rift_choice.h) in the mesh of all views. Where there heavy edges span a gap, here the surface ends:
/// edges of exactly one face. They form closed lines, and lines that have a vertex in common are one rift. As
/// there the rift vertex is the centroid, joined to all vertices on the line; dist is the length of the
/// shortest path over the surface from what the camera looks at to the rift vertex, and weight = 0.5 dist +
/// 0.5 edges.
///
/// Departure: no delta_m is set by hand. What a sample says is uncertain over
///   rho^2 = v^2 + s^2 + 12 sigma_d^2
/// with the voxel v, the least spacing s of pixels there, and the sensor's error at the least distance seen
/// from, as in the weights of FusedSurface. The mesh ends up to one voxel before what was seen. A gap
/// narrower than rho + v on either side of its middle may thus be no gap, and a line shorter than the
/// perimeter of such a square, 8 (rho + v), with the mean rho of its vertices, is no rift.
///
/// A rift is the one before with which it has most vertices in common; else the one from which it lies at
/// most one block away, since surface grows by views, not by vertices. So the largest part of a rift that
/// splits goes on, and so does the largest of those that merge.
///
/// Threading: one thread owns it.
class MeshRifts {
 public:
  static constexpr std::size_t kMostEnded = 64;

  MeshRifts(double voxel_size, const DepthErrorModel& depth_error)
      : voxel_size_(voxel_size), depth_error_(depth_error) {}

  /// Follows the mesh. Costs as much as what has changed.
  /// @param updated  What SurfaceMesh::Update returned.
  void Update(const SurfaceMesh& mesh, std::span<const VoxelIndex> updated);

  /// Finds the rifts of the mesh that was followed last. Costs as much as the border is long, and a search
  /// over the mesh's blocks.
  /// @param looked_at_W  What the camera looks at; without it, or if there is no surface around it, no
  ///   distance is known.
  void Find(const SurfaceMesh& mesh, const std::optional<Eigen::Vector3d>& looked_at_W);

  /// As of the last Find: heaviest first; then those without a path, longest first.
  const std::vector<MeshRift>& open() const { return open_; }
  /// Those that were open, the latest first; not more than kMostEnded.
  const std::deque<MeshRift>& ended() const { return ended_; }

 private:
  struct Vertex {
    MeshVertex::Id id;
    MeshPatches::Place place;
    Eigen::Vector3f normal_W;
    double resolution;  ///< [m] rho.
  };
  struct Candidate {
    MeshRift rift;
    std::vector<Vertex> vertices;
  };
  double ResolutionAt(const BlockMesh::Vertex& vertex) const;
  std::vector<Candidate> Lines(const SurfaceMesh& mesh) const;
  void Measure(Candidate& candidate, const std::optional<MeshPatches::Paths>& paths) const;
  void Identify(std::vector<Candidate>& candidates);

  double voxel_size_;
  DepthErrorModel depth_error_;
  MeshBorder border_;
  MeshPatches patches_;
  std::vector<MeshRift> open_;
  std::deque<MeshRift> ended_;
  /// The numbers of the open rifts at their vertices, in ascending order of these.
  std::vector<std::pair<MeshVertex::Id, std::uint32_t>> number_at_;
  std::uint32_t last_number_ = 0;
};

}  // namespace thalweg::surface
