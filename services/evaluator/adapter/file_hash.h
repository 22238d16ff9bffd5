#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "common/base/hash.h"

namespace thalweg::evaluator {

/// Hash of a file's content; of nothing when it cannot be read.
/// @param hash  Hash of the preceding bytes.
inline std::uint64_t HashOfFile(const std::filesystem::path& file, std::uint64_t hash = HashOf("")) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  return HashOf(bytes.str(), hash);
}

/// 16 hexadecimal digits.
inline std::string HashText(std::uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

}  // namespace thalweg::evaluator
