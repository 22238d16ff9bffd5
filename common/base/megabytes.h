#pragma once

#include <cstdint>
#include <string>

namespace thalweg {

/// [byte] A megabyte, as fields of a scenario, options of a command and messages to people count it.
inline constexpr std::uint64_t kMegabyte = 1'000'000;

/// [MB] From bytes.
constexpr double Megabytes(double bytes) {
  return 1e-6 * bytes;
}

/// [byte] From megabytes, rounded down.
constexpr std::uint64_t BytesFromMegabytes(double megabytes) {
  return static_cast<std::uint64_t>(static_cast<double>(kMegabyte) * megabytes);
}

/// A size for people: "45.2 MB".
std::string MegabytesText(double bytes);

}  // namespace thalweg
