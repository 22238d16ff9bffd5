#pragma once

#include <string_view>

namespace thalweg {

/// Version of thalweg, as project() of the top CMakeLists.txt states it, e.g. "0.2.0".
std::string_view Version();

}  // namespace thalweg
