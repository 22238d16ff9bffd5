#pragma once

#include <concepts>
#include <string>

namespace thalweg {

/// The size of an image for a message: "640 x 480". Of any integers, since a size that is refused need not
/// fit into the type of one that is accepted.
template <std::integral Pixels>
std::string SizeText(Pixels width_px, Pixels height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px);
}

}  // namespace thalweg
