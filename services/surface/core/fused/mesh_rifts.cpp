#include "services/surface/core/fused/mesh_rifts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "common/surface_graph/rift_choice.h"
#include "common/voxel/for_each_voxel.h"
#include "common/voxel/grid_order.h"

namespace thalweg::surface {
namespace {

constexpr RiftWeights kWeights;

/// Normals whose mean is shorter cancel each other out.
constexpr float kLeastMeanNormal = 1e-3F;

using Numbered = std::pair<MeshVertex::Id, std::uint32_t>;

/// A rift that may be one of those before.
struct Match {
  std::size_t vertices;  ///< By which they match.
  std::uint32_t number;  ///< The number of the one before.
  std::size_t candidate;
};

/// The best ones first.
void Order(std::vector<Match>& matches) {
  const auto key = [](const Match& match) {
    return std::tuple(-static_cast<std::ptrdiff_t>(match.vertices), match.number, match.candidate);
  };
  std::ranges::sort(matches, {}, key);
}

}  // namespace

void MeshRifts::Update(const SurfaceMesh& mesh, std::span<const VoxelIndex> updated) {
  border_.Update(mesh, updated);
  patches_.Update(mesh, updated);
}

double MeshRifts::ResolutionAt(const BlockMesh::Vertex& vertex) const {
  if (!vertex.best.seen()) return voxel_size_;
  const double spacing = static_cast<double>(vertex.best.sampling());
  const double distance = static_cast<double>(vertex.best.distance());
  const double sigma_d = depth_error_.sigma * distance * distance;
  return std::sqrt(voxel_size_ * voxel_size_ + spacing * spacing + 12.0 * sigma_d * sigma_d);
}

/// The lines of the border that are long enough, with their vertices, lengths and edges.
std::vector<MeshRifts::Candidate> MeshRifts::Lines(const SurfaceMesh& mesh) const {
  std::vector<VoxelIndex> blocks;
  blocks.reserve(border_.edges().size());
  for (const auto& [block, edges] : border_.edges()) blocks.push_back(block);
  std::ranges::sort(blocks, GridOrder());

  // Vertices within a block are known by their indices there; only others need a search.
  constexpr std::uint32_t kNew = std::numeric_limits<std::uint32_t>::max();
  std::unordered_map<MeshVertex::Id, std::uint32_t> on_rims;
  std::vector<std::uint32_t> number_of;  // by index in the block
  std::vector<Vertex> vertices;
  std::vector<std::array<std::uint32_t, 2>> sides;
  for (const VoxelIndex& block : blocks) {
    const BlockMesh& its_mesh = mesh.blocks().at(block);
    const std::vector<MeshPatches::Id>& patches = patches_.PatchesOf(block);
    number_of.assign(its_mesh.vertices.size(), kNew);
    const auto add = [&](MeshVertex::Id id, std::uint16_t index) {
      std::uint32_t& number = number_of[index];
      if (number != kNew) return number;
      number = static_cast<std::uint32_t>(vertices.size());
      if (IsOnRim(block, MeshVertex::Of(id))) {
        const auto [known, is_new] = on_rims.try_emplace(id, number);
        if (!is_new) return number = known->second;
      }
      const BlockMesh::Vertex& vertex = its_mesh.vertices[index];
      vertices.push_back({id, {patches[index], vertex.p_W}, vertex.normal_W, ResolutionAt(vertex)});
      return number;
    };
    for (const BorderEdge& edge : border_.edges().at(block)) {
      const std::uint32_t from = add(edge.from, edge.from_index);
      sides.push_back({from, add(edge.to, edge.to_index)});
    }
  }

  std::vector<std::uint32_t> parent(vertices.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& [from, to] : sides) {
    const auto [low, high] = std::minmax({root(from), root(to)});
    parent[high] = low;
  }

  struct Sum {
    double length = 0.0;
    double resolution = 0.0;
    double vertices = 0.0;
    std::size_t line = 0;  // from 1, once the line is long enough
  };
  std::vector<Sum> sums(vertices.size());  // by root
  const auto length_of = [&](const std::array<std::uint32_t, 2>& side) {
    return static_cast<double>((vertices[side[1]].place.p_W - vertices[side[0]].place.p_W).norm());
  };
  for (const auto& side : sides) sums[root(side[0])].length += length_of(side);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    Sum& sum = sums[root(i)];
    sum.resolution += vertices[i].resolution;
    sum.vertices += 1.0;
  }
  std::vector<Candidate> lines;
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    Sum& sum = sums[root(i)];
    if (sum.length < 8.0 * (sum.resolution / sum.vertices + voxel_size_)) continue;
    if (sum.line == 0) {
      lines.emplace_back().rift.length = sum.length;
      sum.line = lines.size();
    }
    lines[sum.line - 1].vertices.push_back(vertices[i]);
  }
  for (const auto& [from, to] : sides) {
    const std::size_t line = sums[root(from)].line;
    if (line == 0) continue;
    MeshRift& rift = lines[line - 1].rift;
    ++rift.edges;
    rift.line_W.push_back({vertices[from].place.p_W, vertices[to].place.p_W});
  }
  return lines;
}

/// Fills in the place, the normal, the distance and the weight.
void MeshRifts::Measure(Candidate& candidate, const std::optional<MeshPatches::Paths>& paths) const {
  MeshRift& rift = candidate.rift;
  Eigen::Vector3d sum_W = Eigen::Vector3d::Zero();
  Eigen::Vector3f normals_W = Eigen::Vector3f::Zero();
  for (const Vertex& vertex : candidate.vertices) {
    sum_W += vertex.place.p_W.cast<double>();
    normals_W += vertex.normal_W;
  }
  const auto count = static_cast<double>(candidate.vertices.size());
  rift.center_W = (sum_W / count).cast<float>();
  if (normals_W.norm() > kLeastMeanNormal * static_cast<float>(count)) rift.normal_W = normals_W.normalized();
  const auto to_center = [&](const Vertex& vertex) {
    return static_cast<double>((vertex.place.p_W - rift.center_W).norm());
  };
  if (paths) {
    for (const Vertex& vertex : candidate.vertices) {
      const double length = paths->To(vertex.place) + to_center(vertex);
      if (length >= rift.distance) continue;
      rift.distance = length;
      rift.nearest_W = vertex.place.p_W;
    }
  }
  if (rift.distance < MeshRift::kNoPath) {
    rift.weight = kWeights.distance * rift.distance + kWeights.edges * rift.edges;  // Eq. (5.11)
  } else {
    rift.nearest_W = std::ranges::min_element(candidate.vertices, {}, to_center)->place.p_W;
  }
}

/// Gives each the number of the one before that it is, or a new one, and ends those that are no more.
void MeshRifts::Identify(std::vector<Candidate>& candidates) {
  std::set<std::uint32_t> going_on;  // numbers of those before
  const auto assign = [&](std::vector<Match>& matches) {
    Order(matches);
    for (const Match& match : matches) {
      MeshRift& rift = candidates[match.candidate].rift;
      if (rift.number != 0 || going_on.contains(match.number)) continue;
      rift.number = match.number;
      going_on.insert(match.number);
    }
  };
  std::vector<Match> in_common;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    std::map<std::uint32_t, std::size_t> counts;
    for (const Vertex& vertex : candidates[k].vertices) {
      const auto found = std::ranges::lower_bound(number_at_, vertex.id, {}, &Numbered::first);
      if (found != number_at_.end() && found->first == vertex.id) ++counts[found->second];
    }
    for (const auto& [number, count] : counts) in_common.push_back({count, number, k});
  }
  assign(in_common);

  std::unordered_map<VoxelIndex, std::vector<std::uint32_t>, VoxelIndexHash> left_around;
  for (const auto& [id, number] : number_at_) {
    if (going_on.contains(number)) continue;
    ForEachVoxel(CubeAround(BlockOf(MeshVertex::Of(id).voxel), 1),
                 [&, its = number](const VoxelIndex& block) {
                   auto& numbers = left_around[block];
                   if (std::ranges::find(numbers, its) == numbers.end()) numbers.push_back(its);
                 });
  }
  std::vector<Match> near;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (candidates[k].rift.number != 0) continue;
    std::map<std::uint32_t, std::size_t> counts;
    for (const Vertex& vertex : candidates[k].vertices) {
      const auto found = left_around.find(BlockOf(MeshVertex::Of(vertex.id).voxel));
      if (found == left_around.end()) continue;
      for (const std::uint32_t number : found->second) ++counts[number];
    }
    for (const auto& [number, count] : counts) near.push_back({count, number, k});
  }
  assign(near);

  for (Candidate& candidate : candidates) {
    if (candidate.rift.number == 0) candidate.rift.number = ++last_number_;
  }
  std::map<std::uint32_t, std::uint32_t> taken_by;  // the best matches come first
  for (const Match& match : in_common)
    taken_by.emplace(match.number, candidates[match.candidate].rift.number);
  std::ranges::sort(open_, {}, &MeshRift::number);
  for (MeshRift& before : open_) {
    if (going_on.contains(before.number)) continue;
    const auto taken = taken_by.find(before.number);
    before.fate = taken == taken_by.end() ? MeshRift::Fate::kClosed : MeshRift::Fate::kMerged;
    if (taken != taken_by.end()) before.merged_into = taken->second;
    before.line_W.clear();
    ended_.push_front(std::move(before));
  }
  while (ended_.size() > kMostEnded) ended_.pop_back();
}

void MeshRifts::Find(const SurfaceMesh& mesh, const std::optional<Eigen::Vector3d>& looked_at_W) {
  std::optional<MeshPatches::Paths> paths;
  if (looked_at_W) {
    if (const auto start = patches_.Nearest(mesh, *looked_at_W, voxel_size_)) paths.emplace(patches_, *start);
  }
  std::vector<Candidate> candidates = Lines(mesh);
  for (Candidate& candidate : candidates) Measure(candidate, paths);
  Identify(candidates);
  open_.clear();
  number_at_.clear();
  for (Candidate& candidate : candidates) {
    for (const Vertex& vertex : candidate.vertices) number_at_.emplace_back(vertex.id, candidate.rift.number);
    open_.push_back(std::move(candidate.rift));
  }
  std::ranges::sort(number_at_);
  std::ranges::sort(open_, {},
                    [](const MeshRift& rift) { return std::tuple(-rift.weight, -rift.length, rift.number); });
}

}  // namespace thalweg::surface
