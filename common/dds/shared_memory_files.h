#pragma once

#include <cstdint>
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

/// Chooses, at random, the first of two ports for a participant in `domain` that are neither in use nor left
/// behind. Their numbers are beyond those of UDP. There are 500 pairs; if none of them is fresh, returns
/// that which was left behind the longest ago; if all are in use, one of them.
///
/// By default Fast DDS takes the ports of the lowest free ID, so that a restarted process gets those of the
/// killed one, to which its peers still write. They mistake the new port for the dead one and remove it, or
/// keep writing to the removed one: the new process receives nothing (Fast DDS issue 5469). What is left
/// behind stays as long as anybody listens in the domain: peers keep it in memory anyhow, 52 kB a port, and
/// how a process ended cannot be seen by it, since a peer that finds a killed one's port leaves it as one
/// that ended.
std::uint32_t FreshSharedPorts(int domain, const std::filesystem::path& folder = "/dev/shm");

}  // namespace thalweg::dds
