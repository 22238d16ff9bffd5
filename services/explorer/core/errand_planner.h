#pragma once

#include "common/base/result.h"
#include "services/explorer/core/errand.h"
#include "services/explorer/core/explorer_options.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/mission.h"
#include "services/explorer/core/task_maker.h"
#include "services/explorer/core/view/goal_finder.h"

namespace thalweg::explorer {

/// Makes the tasks for errands: an operator's, or those of an explorer that looks at what shuts a way.
class ErrandPlanner {
 public:
  explicit ErrandPlanner(const ExplorerOptions& options);

  /// Error: as FindErrandPath, or a budget does not allow the path.
  /// @param make  For the same robot and map.
  Result<Task> MakeTask(const Errand& errand, const RigidTransform& T_WB, Time now, const TaskMaker& make,
                        const Mission& mission, Knowledge& knowledge) const;

 private:
  ErrandOptions options_;
  GoalFinder goal_finder_;
};

}  // namespace thalweg::explorer
