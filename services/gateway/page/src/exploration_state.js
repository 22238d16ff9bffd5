// Values of ExplorationState in thalweg_msgs.
export const DONE = 4;
export const PAUSED = 5;
