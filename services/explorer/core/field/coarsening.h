#pragma once

#include "services/explorer/core/field/multigrid.h"

namespace thalweg::explorer::field {

/// Fills `coarse` (layout, operator, segments), `fine.moved` and the parents in `fine.links`.
/// @param fine   Level of `grid`.
/// @param grid   Operator of the fine level: the problem itself for the finest level, otherwise `fine`.
/// @param index  Index of the coarse level; the finest level has index 0.
template <class Grid>
void Coarsen(const Grid& grid, Level& fine, Level& coarse, int index, Team& team);

extern template void Coarsen<FineProblem>(const FineProblem&, Level&, Level&, int, Team&);
extern template void Coarsen<Level>(const Level&, Level&, Level&, int, Team&);

}  // namespace thalweg::explorer::field
