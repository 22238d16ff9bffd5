#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/inspector/core/diagnosis.h"

namespace thalweg::inspector {

// Facts about this machine, from /proc, /sys and its network interfaces.

std::string OwnUser();  ///< The name of the user as whom this process runs.
std::string OwnHost();  ///< The name by which participants on this machine say where they are.

/// A number in a file of one line, such as /proc/sys/net/core/rmem_max; nothing if there is none.
std::optional<std::uint64_t> NumberInFile(const std::filesystem::path& file);

/// The DDS domains in which processes of this machine listen, by the ports on which each participant of a
/// domain hears the announcements of others, and what is sent to itself [RTPS 2.5, section 9.6.2]. Without
/// this process.
/// @param proc  /proc, or a copy of its files in a test.
std::vector<DomainFacts> DomainsInUse(const std::filesystem::path& proc = "/proc");

/// /dev/shm: its room, owner, what killed processes left there and who else uses it.
SharedMemoryFacts ReadSharedMemory(const std::filesystem::path& folder = "/dev/shm");

/// This machine's interfaces, and whether each returns a datagram that is sent to a multicast group.
std::vector<InterfaceFacts> ReadInterfaces();

/// Bytes that are free for a file in the folder or, if that does not exist yet, in the one where it would be
/// made.
std::optional<std::uint64_t> FreeBytes(std::filesystem::path folder);

}  // namespace thalweg::inspector
