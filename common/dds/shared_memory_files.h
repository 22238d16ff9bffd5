#pragma once

#include <filesystem>

namespace thalweg::dds {

/// What Fast DDS keeps in shared memory, in files: a segment for each participant's samples, and for each of
/// its ports ("fastrtps_port" + the RTPS port number) a queue with its locks. A process that is killed leaves
/// all of it behind.

/// Removes what is nobody's: segments whose process was killed, each of which would go on holding its whole
/// size, and the ports of domains in which nobody listens any more. A living process holds the lock of what
/// is its own. Files younger than ten seconds, whose owner may be about to lock them, and what belongs to
/// other users stays.
/// @return How many segments and ports were removed.
int RemoveStaleFiles(const std::filesystem::path& folder = "/dev/shm");

/// A participant id for `domain` none of whose ports is in use or was left behind, by chance one of those;
/// when there is none the one left behind the longest ago; -1 when all are in use. Left to itself Fast DDS
/// takes the lowest one: a process that is started again then gets the ports of the one that was killed, in
/// which its peers still write. They take the new port for the dead one and remove it, or write into the
/// removed one for ever: it is deaf (Fast DDS issue 5469).
int FreshParticipantId(int domain, const std::filesystem::path& folder = "/dev/shm");

}  // namespace thalweg::dds
