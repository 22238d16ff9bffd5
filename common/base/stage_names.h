#pragma once

namespace thalweg {

/// The explorer publishes how long each stage of its planning takes; this one is a whole decision, of which
/// the others are parts. Whoever sums up a run looks for it.
inline constexpr auto kPlanStage = "plan";

}  // namespace thalweg
