#pragma once

#include <filesystem>
#include <stdexcept>
#include <string_view>

namespace thalweg {

/// Writes the file whole or not at all, whenever the process may die: into a file beside it, onto the disk,
/// then renamed. Makes the folder where there is none. A link, and what exists and is no regular file, such
/// as a pipe or /dev/stdout, is written in place. Throws std::runtime_error "FILE: cannot be written:
/// REASON".
void WriteFile(const std::filesystem::path& file, std::string_view bytes);

/// The error above, for those who write in another way. @param error  An errno; 0 = not known.
std::runtime_error CannotWrite(const std::filesystem::path& file, int error);

/// Throws the same when WriteFile could not write the file, and leaves its contents as they are: for finding
/// out before hours of work instead of after them.
void CheckWritable(const std::filesystem::path& file);

}  // namespace thalweg
