#pragma once

#include <filesystem>

namespace thalweg::dds {

/// Removes the shared-memory segments of Fast DDS whose process was killed; each would go on holding its
/// whole size. A living process holds the lock of its segment, so what can be locked is nobody's. Segments
/// younger than ten seconds, whose owner may be about to lock them, and those of other users stay.
/// @return How many were removed.
int RemoveStaleSegments(const std::filesystem::path& folder = "/dev/shm");

}  // namespace thalweg::dds
