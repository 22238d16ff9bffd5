#pragma once

#include <filesystem>
#include <vector>

namespace thalweg::dds {

/// Manages the files that Fast DDS keeps in shared memory: a segment for each participant's samples, and for
/// each of its ports ("fastrtps_port" + the RTPS port number) a queue with its locks. A process that is
/// killed leaves all of them behind.

/// Removes abandoned files: segments of killed processes, which would otherwise occupy their whole size, and
/// the ports of domains in which no process listens any more. A living process holds locks on its own files.
/// Keeps files younger than ten seconds, whose owner may be about to lock them, and files of other users.
/// @return Number of segments and ports removed.
int RemoveStaleFiles(const std::filesystem::path& folder = "/dev/shm");

/// The files that RemoveStaleFiles would remove: segments and ports, without their locks.
std::vector<std::filesystem::path> StaleFiles(const std::filesystem::path& folder = "/dev/shm");

/// Chooses, at random, a participant ID for `domain` whose ports are neither in use nor left behind. If there
/// is none, returns the ID that was left behind longest ago; -1 if all are in use.
///
/// By default Fast DDS takes the lowest free ID, so that a restarted process gets the ports of the killed
/// one, to which its peers still write. They mistake the new port for the dead one and remove it, or keep
/// writing to the removed one: the new process receives nothing (Fast DDS issue 5469).
int FreshParticipantId(int domain, const std::filesystem::path& folder = "/dev/shm");

}  // namespace thalweg::dds
