#pragma once

#include <string_view>

namespace thalweg {

/// Version of thalweg as set by project() in the top-level CMakeLists.txt, e.g. "0.2.0".
std::string_view Version();

}  // namespace thalweg
