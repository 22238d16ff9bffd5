// The enums of idl/thalweg_msgs.idl that the page shows, in their order there (a test compares).
export const STATES = [["Waiting", "warn"], ["Looking", "go"], ["Planning", "go"], ["Moving", "go"], ["Done", "good"],
  ["Paused", "warn"]]; // ExplorationState: name and tone
export const DONE = 4;
export const PAUSED = 5;
export const OUTCOMES = ["", "Complete", "Too much unknown", "Nothing reachable", "No free space", "Time is up", "Distance used up",
  "No path home", "Ended", "Ended by the operator", "The strategy does not apply",
  "The strategy cannot go on"]; // ExplorationOutcome
export const FATES = ["Not seen yet", "Chosen", "Set aside"]; // FrontierFate
export const CHOSEN = 1;
export const SET_ASIDE = 2;
export const REASONS = ["", "looked at and stayed unknown", "visited without progress", "seen from no reachable place", "lost or stopped on the way there",
  "nothing was measured there: too little texture, or too far?", "ignored by the operator", "too small to matter",
  "no room to turn to it"]; // AsideReason
