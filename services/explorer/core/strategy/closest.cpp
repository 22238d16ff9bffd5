#include "services/explorer/core/strategy/closest.h"

namespace thalweg::explorer {

Choice Closest::Choose(const Situation& situation) {
  Choice choice = StraightTo(situation, NearestCandidate(situation));
  for (const Candidate& candidate : situation.candidates) choice.scores.push_back(-candidate.length);
  return choice;
}

}  // namespace thalweg::explorer
