#include "services/explorer/core/field/coarsening.h"

#include <algorithm>
#include <array>
#include <bit>

#include "services/explorer/core/field/multigrid_constants.h"

namespace thalweg::explorer::field {
namespace {

/// A fine node that is not simply the child of its block: it belongs to the `part`-th further part, or to
/// none (-1).
struct Apart {
  std::size_t node;
  std::size_t block;
  int part;
};

/// Which of the 256 subsets of the cells of a 2x2x2 block are connected, given links between all face
/// neighbors.
constexpr std::array<bool, 256> kConnected = [] {
  std::array<bool, 256> connected{};
  for (unsigned cells = 1; cells < 256; ++cells) {
    unsigned seen = cells & (~cells + 1);
    for (int step = 0; step < 8; ++step) {
      const unsigned along_x = (seen & 0x55U) << 1 | (seen & 0xAAU) >> 1;
      const unsigned along_y = (seen & 0x33U) << 2 | (seen & 0xCCU) >> 2;
      const unsigned along_z = (seen & 0x0FU) << 4 | (seen & 0xF0U) >> 4;
      seen |= (along_x | along_y | along_z) & cells;
    }
    connected[cells] = seen == cells;
  }
  return connected;
}();

template <class Grid>
class Coarsener {
 public:
  Coarsener(const Grid& grid, Level& fine, Level& coarse, int index)
      : grid_(grid), fine_(fine), coarse_(coarse), index_(index), layout_(fine.layout) {
    coarse_.layout = layout_.Halved();
    strides_ = {1, layout_.stride_y, layout_.stride_z};
    coarse_strides_ = {1, coarse_.layout.stride_y, coarse_.layout.stride_z};
    for (std::size_t k = 0; k < 8; ++k) {
      child_[k] = (k & 1) + (k >> 1 & 1) * layout_.stride_y + (k >> 2) * layout_.stride_z;
    }
  }

  void Run(Team& team) {
    IndexLinks();
    active_.assign(coarse_.layout.total, 0);
    const int planes = coarse_.layout.nz;
    std::vector<std::vector<Apart>> apart(static_cast<std::size_t>(team.count()));
    team.ForParts(planes, layout_.total, [&](int begin, int end, int k) {
      for (int z = begin; z < end; ++z) FindParts(z, apart[static_cast<std::size_t>(k)]);
    });
    NumberParts(apart);

    const std::size_t nodes = coarse_.layout.total + coarse_.further;
    for (Buffer<float>* b : {&coarse_.diagonal, &coarse_.weight_x, &coarse_.weight_y, &coarse_.weight_z,
                             &coarse_.slack, &coarse_.mass, &coarse_.r, &coarse_.z, &coarse_.work}) {
      b->Reset(nodes, team);
    }
    team.ForParts(planes, layout_.total, [&](int begin, int end, int) {
      for (int z = begin; z < end; ++z) SumPlane(z);
    });
    MoveParts();
    std::vector<Segments> segments(static_cast<std::size_t>(team.count()));
    std::vector<std::size_t> unknowns(segments.size(), 0);
    team.ForParts(planes, layout_.total, [&](int begin, int end, int k) {
      const auto part = static_cast<std::size_t>(k);
      for (int z = begin; z < end; ++z) unknowns[part] += FinishPlane(z);
      AppendSegments(
          coarse_.layout, begin, end, [this](std::size_t i) { return active_[i] != 0; }, segments[part]);
    });
    FinishFurther();
    coarse_.unknowns = coarse_.further;
    for (const std::size_t n : unknowns) coarse_.unknowns += n;
    coarse_.segments = Concatenate(segments);
  }

 private:
  struct Incidence {
    std::size_t node;
    std::size_t other;
    bool operator<(const Incidence& o) const { return node < o.node || (node == o.node && other < o.other); }
  };
  struct InBlock {
    std::size_t block;
    std::size_t node;
    bool operator<(const InBlock& o) const { return block < o.block || (block == o.block && node < o.node); }
  };

  /// Indexes the explicit links of each node and the further nodes of each block.
  void IndexLinks() {
    for (const Link& link : fine_.links) {
      incidences_.push_back({link.a, link.b});
      incidences_.push_back({link.b, link.a});
    }
    std::sort(incidences_.begin(), incidences_.end());
    for (std::size_t k = 0; k < fine_.further; ++k) {
      in_block_.push_back({fine_.layout.Parent(fine_.further_place[k], coarse_.layout), layout_.total + k});
    }
    std::sort(in_block_.begin(), in_block_.end());
  }

  void FindParts(int z, std::vector<Apart>& apart) {
    for (int y = 0; y < coarse_.layout.ny; ++y) {
      const std::size_t block_row = coarse_.layout.Row(y, z);
      const std::size_t cell_row = layout_.Row(2 * y, 2 * z);
      auto further = std::lower_bound(in_block_.begin(), in_block_.end(), InBlock{block_row, 0});
      for (std::size_t x = 0; x < static_cast<std::size_t>(coarse_.layout.nx); ++x) {
        const std::size_t cell = cell_row + 2 * x;
        const std::size_t block = block_row + x;
        unsigned cells = 0;
        for (unsigned k = 0; k < 8; ++k) cells |= (grid_.Active(cell + child_[k]) ? 1U : 0U) << k;
        const bool has_further = further != in_block_.end() && further->block == block;
        if (cells == 0 && !has_further) continue;
        if (!has_further && Whole(cell, cells)) {
          active_[block] = 1;
          continue;
        }
        const auto begin = further;
        while (further != in_block_.end() && further->block == block) ++further;
        SplitBlock(cell, block, cells, {begin, further}, apart);
      }
    }
  }

  /// Whether the cells form one part that has links, inside or to others.
  bool Whole(std::size_t cell, unsigned cells) const {
    if (std::popcount(cells) == 1) {
      return HasLinks(cell + child_[static_cast<std::size_t>(std::countr_zero(cells))]);
    }
    if constexpr (std::is_same_v<Grid, FineProblem>) return kConnected[cells];
    unsigned seen = cells & (~cells + 1);
    for (unsigned before = 0; before != seen;) {
      before = seen;
      for (unsigned k = 0; k < 8; ++k) {
        for (unsigned axis = 0; axis < 3; ++axis) {
          const unsigned bit = 1U << axis;
          if ((k & bit) != 0 ||
              grid_.Weight(static_cast<int>(axis), cell + child_[k], strides_[axis]) <= 0.0F) {
            continue;
          }
          const unsigned pair = 1U << k | 1U << (k | bit);
          if ((seen & pair) != 0) seen |= pair;
        }
      }
    }
    return seen == cells;
  }

  bool HasLinks(std::size_t node) const {
    if (node < layout_.total) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t stride = strides_[axis];
        if (grid_.Weight(static_cast<int>(axis), node, stride) > 0.0F) return true;
        if (grid_.Weight(static_cast<int>(axis), node - stride, stride) > 0.0F) return true;
      }
    }
    const auto found = std::lower_bound(incidences_.begin(), incidences_.end(), Incidence{node, 0});
    return found != incidences_.end() && found->node == node;
  }

  /// Splits the nodes of a block into connected parts; the one with the most cells stays in the grid.
  void SplitBlock(
      std::size_t cell, std::size_t block, unsigned cells,
      std::pair<typename std::vector<InBlock>::const_iterator, typename std::vector<InBlock>::const_iterator>
          further,
      std::vector<Apart>& apart) {
    std::vector<std::size_t> nodes;
    for (std::size_t k = 0; k < 8; ++k) {
      if ((cells >> k & 1U) != 0) nodes.push_back(cell + child_[k]);
    }
    for (auto it = further.first; it != further.second; ++it) nodes.push_back(it->node);
    std::vector<std::size_t> part(nodes.size());
    for (std::size_t k = 0; k < nodes.size(); ++k) part[k] = k;
    const auto join = [&part](std::size_t a, std::size_t b) {
      const std::size_t from = std::max(part[a], part[b]);
      const std::size_t to = std::min(part[a], part[b]);
      std::replace(part.begin(), part.end(), from, to);
    };
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      for (std::size_t b = a + 1; b < nodes.size(); ++b) {
        if (Linked(nodes[a], nodes[b])) join(a, b);
      }
    }
    std::vector<std::size_t> size(nodes.size(), 0);
    std::vector<bool> linked(nodes.size(), false);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      size[part[k]] += nodes[k] < layout_.total ? 8 * nodes.size() : 1;
      if (part[k] != k || HasLinks(nodes[k])) linked[part[k]] = true;
    }
    std::size_t largest = kNone;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (linked[k] && size[k] > 0 && (largest == kNone || size[k] > size[largest])) largest = k;
    }
    if (largest != kNone) active_[block] = 1;
    std::vector<int> number(nodes.size(), -1);
    int count = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const std::size_t p = part[k];
      if (p == largest) {
        if (nodes[k] >= layout_.total) apart.push_back({nodes[k], block, 0});
        continue;
      }
      if (linked[p] && number[p] < 0) number[p] = ++count;
      apart.push_back({nodes[k], block, number[p]});
    }
  }

  bool Linked(std::size_t a, std::size_t b) const {
    if (b < layout_.total) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (b - a == strides_[axis]) return grid_.Weight(static_cast<int>(axis), a, strides_[axis]) > 0.0F;
      }
      return false;
    }
    return std::binary_search(incidences_.begin(), incidences_.end(), Incidence{a, b});
  }

  /// Numbers the further parts in the order of their blocks, whatever the number of threads.
  void NumberParts(const std::vector<std::vector<Apart>>& apart) {
    fine_.moved.clear();
    coarse_.further_place.clear();
    std::size_t block = kNone;
    std::size_t first = 0;  // number preceding the block's first further part
    for (const std::vector<Apart>& list : apart) {
      for (const Apart& a : list) {
        if (a.block != block) first = coarse_.further_place.size();
        block = a.block;
        const std::size_t implied = a.node < layout_.total ? a.block : kNone;
        std::size_t parent = a.part < 0 ? kNone : a.block;
        if (a.part > 0) {
          const std::size_t number = first + static_cast<std::size_t>(a.part) - 1;
          if (number == coarse_.further_place.size()) coarse_.further_place.push_back(a.block);
          parent = coarse_.layout.total + number;
        }
        fine_.moved.push_back({a.node, implied, parent});
      }
    }
    std::sort(fine_.moved.begin(), fine_.moved.end(),
              [](const Moved& a, const Moved& b) { return a.node < b.node; });
    coarse_.further = coarse_.further_place.size();
  }

  void SumPlane(int z) {
    for (int y = 0; y < coarse_.layout.ny; ++y) {
      const std::size_t block_row = coarse_.layout.Row(y, z);
      const std::size_t cell_row = layout_.Row(2 * y, 2 * z);
      for (std::size_t x = 0; x < static_cast<std::size_t>(coarse_.layout.nx); ++x) {
        const std::size_t block = block_row + x;
        if (active_[block] == 0) continue;
        SumBlock(cell_row + 2 * x, block);
      }
    }
  }

  /// Sums what the regular grid implies; MoveParts corrects the exceptions.
  void SumBlock(std::size_t cell, std::size_t block) {
    float weight[3] = {0.0F, 0.0F, 0.0F};
    float slack = 0.0F;
    float mass = 0.0F;
    for (unsigned k = 0; k < 8; ++k) {
      const std::size_t i = cell + child_[k];
      slack += grid_.Slack(i);
      mass += grid_.Mass(i);
      for (unsigned axis = 0; axis < 3; ++axis) {
        if ((k >> axis & 1U) != 0) weight[axis] += grid_.Weight(static_cast<int>(axis), i, strides_[axis]);
      }
    }
    coarse_.weight_x[block] = kFaceScale * weight[0];
    coarse_.weight_y[block] = kFaceScale * weight[1];
    coarse_.weight_z[block] = kFaceScale * weight[2];
    coarse_.slack[block] = kFaceScale * slack;
    coarse_.mass[block] = kMassScale * mass;
  }

  std::size_t ParentOf(std::size_t node) const {
    const auto found = std::lower_bound(fine_.moved.begin(), fine_.moved.end(), node,
                                        [](const Moved& m, std::size_t n) { return m.node < n; });
    if (found != fine_.moved.end() && found->node == node) return found->parent;
    return layout_.Parent(node, coarse_.layout);
  }
  bool IsMoved(std::size_t node) const {
    const auto found = std::lower_bound(fine_.moved.begin(), fine_.moved.end(), node,
                                        [](const Moved& m, std::size_t n) { return m.node < n; });
    return found != fine_.moved.end() && found->node == node;
  }

  void MoveParts() {
    coarse_.links.clear();
    for (const Moved& m : fine_.moved) {
      if (m.implied != kNone && active_[m.implied] != 0) {
        coarse_.slack[m.implied] -= kFaceScale * grid_.Slack(m.node);
        coarse_.mass[m.implied] -= kMassScale * grid_.Mass(m.node);
      }
      if (m.parent != kNone) {
        coarse_.slack[m.parent] += kFaceScale * grid_.Slack(m.node);
        coarse_.mass[m.parent] += kMassScale * grid_.Mass(m.node);
      }
      if (m.node < layout_.total) MoveFaces(m);
    }
    for (Link& link : fine_.links) {
      link.parent_a = ParentOf(link.a);
      link.parent_b = ParentOf(link.b);
      AddLink(link.parent_a, link.parent_b, kFaceScale * link.weight);
    }
    MergeLinks();
  }

  void MoveFaces(const Moved& m) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const bool forward : {true, false}) {
        const std::size_t low = forward ? m.node : m.node - strides_[axis];
        const float weight = grid_.Weight(static_cast<int>(axis), low, strides_[axis]);
        if (weight <= 0.0F) continue;
        const std::size_t other = forward ? m.node + strides_[axis] : low;
        if (!forward && IsMoved(other)) continue;  // handled from the other end
        const std::size_t implied_low = layout_.Parent(low, coarse_.layout);
        const std::size_t implied_high = layout_.Parent(low + strides_[axis], coarse_.layout);
        // Sums exist for active blocks only, and are complete there.
        if (implied_low != implied_high && active_[implied_low] != 0) {
          WeightAt(axis, implied_low) -= kFaceScale * weight;
        }
        AddLink(ParentOf(m.node), ParentOf(other), kFaceScale * weight);
      }
    }
  }

  float& WeightAt(std::size_t axis, std::size_t i) {
    return axis == 0 ? coarse_.weight_x[i] : axis == 1 ? coarse_.weight_y[i] : coarse_.weight_z[i];
  }

  void AddLink(std::size_t a, std::size_t b, float weight) {
    if (a == b) return;
    const std::size_t low = std::min(a, b);
    const std::size_t high = std::max(a, b);
    if (high < coarse_.layout.total) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (high - low == coarse_strides_[axis]) WeightAt(axis, low) += weight;
      }
      return;
    }
    coarse_.links.push_back({low, high, weight});
  }

  void MergeLinks() {
    std::vector<Link>& links = coarse_.links;
    std::sort(links.begin(), links.end(),
              [](const Link& p, const Link& q) { return p.a < q.a || (p.a == q.a && p.b < q.b); });
    std::size_t kept = 0;
    for (std::size_t k = 0; k < links.size(); ++k) {
      if (kept > 0 && links[kept - 1].a == links[k].a && links[kept - 1].b == links[k].b) {
        links[kept - 1].weight += links[k].weight;
      } else {
        links[kept++] = links[k];
      }
    }
    links.resize(kept);
  }

  /// Computes the diagonal without explicit links. @return Number of nodes in the plane.
  std::size_t FinishPlane(int z) {
    const float factor = SlackFactor(index_);
    const std::size_t dy = coarse_strides_[1];
    const std::size_t dz = coarse_strides_[2];
    std::size_t count = 0;
    for (int y = 0; y < coarse_.layout.ny; ++y) {
      const std::size_t row = coarse_.layout.Row(y, z);
      for (std::size_t i = row; i < row + static_cast<std::size_t>(coarse_.layout.nx); ++i) {
        if (active_[i] == 0) continue;
        ++count;
        coarse_.diagonal[i] = coarse_.weight_x[i] + coarse_.weight_x[i - 1] + coarse_.weight_y[i] +
                              coarse_.weight_y[i - dy] + coarse_.weight_z[i] + coarse_.weight_z[i - dz] +
                              factor * coarse_.slack[i] + coarse_.mass[i];
      }
    }
    return count;
  }

  void FinishFurther() {
    for (std::size_t k = 0; k < coarse_.further; ++k) {
      const std::size_t i = coarse_.layout.total + k;
      coarse_.diagonal[i] = SlackFactor(index_) * coarse_.slack[i] + coarse_.mass[i];
    }
    for (const Link& link : coarse_.links) {
      coarse_.diagonal[link.a] += link.weight;
      coarse_.diagonal[link.b] += link.weight;
    }
  }

  const Grid& grid_;
  Level& fine_;
  Level& coarse_;
  int index_;
  const Layout& layout_;
  std::array<std::size_t, 3> strides_{};
  std::array<std::size_t, 3> coarse_strides_{};
  std::array<std::size_t, 8> child_{};
  std::vector<std::uint8_t> active_;
  std::vector<Incidence> incidences_;
  std::vector<InBlock> in_block_;
};

}  // namespace

template <class Grid>
void Coarsen(const Grid& grid, Level& fine, Level& coarse, int index, Team& team) {
  Coarsener<Grid>(grid, fine, coarse, index).Run(team);
}

template void Coarsen<FineProblem>(const FineProblem&, Level&, Level&, int, Team&);
template void Coarsen<Level>(const Level&, Level&, Level&, int, Team&);

}  // namespace thalweg::explorer::field
