#pragma once

#include "common/base/time.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/task.h"

namespace thalweg::explorer {

/// Remembers what an executed plan left unknown of its target, once a scan from its end is in the map. A look
/// around counts as a look at each of these voxels; when going somewhere showed nothing at all, they are set
/// aside, with what the scan sensed there as the reason. Counts a try for each facet that stayed open.
void RememberArrival(const Task& task, Knowledge& knowledge, Time now);

/// Counts a look at each voxel, and a try for each facet, that is left of the target of a plan on which the
/// robot got lost or was stopped, which need not happen on a second try.
void RememberFailure(const Task& task, Knowledge& knowledge, Time now);

}  // namespace thalweg::explorer
