#pragma once

#include <filesystem>
#include <string_view>

namespace thalweg::mapper {

/// Writes the file whole or not at all, whenever the process may die: into a file beside it, onto the disk,
/// then renamed. Makes the folder where there is none. Throws std::runtime_error naming file and reason.
void WriteFileAtomically(const std::filesystem::path& file, std::string_view bytes);

}  // namespace thalweg::mapper
