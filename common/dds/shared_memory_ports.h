#pragma once

#include <cstdint>

namespace thalweg::dds {

// A process that is killed while it writes into a port of shared memory leaves the port's mutex locked. Fast
// DDS 2.9 gives up on the mutex after a second and replaces the port; a participant that is deleted within
// that second still waits for the mutex of the port that is replaced, and the process dies (SIGSEGV).

/// Sends an empty RTPS message through both ports of this process's participant, so that one that a killed
/// peer left locked is replaced, and waits until the participant has let go of the old one. To be called
/// before the participant is deleted. Takes some milliseconds, up to two seconds for a locked port and at
/// most five seconds.
/// @param first  The first of the ports, of FreshSharedPorts.
void ReplaceLockedPorts(std::uint32_t first);

}  // namespace thalweg::dds
