#pragma once

#include <filesystem>
#include <string_view>

namespace thalweg::mapper {

/// Writes the whole file or nothing, even if the process dies meanwhile: the bytes go to a temporary file
/// beside it, are synced to disk, and the file is then renamed. Creates the folder if needed. Throws
/// std::runtime_error naming file and reason.
void WriteFileAtomically(const std::filesystem::path& file, std::string_view bytes);

}  // namespace thalweg::mapper
