#pragma once

#include <string>

namespace thalweg {

/// The size of an image for a message: "640 x 480".
inline std::string SizeText(int width_px, int height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px);
}

}  // namespace thalweg
