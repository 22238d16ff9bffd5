#pragma once

#include <string>
#include <vector>

namespace thalweg::inspector {

using Rows = std::vector<std::vector<std::string>>;

/// The rows as lines of columns, each as wide as its widest cell and two spaces from the next. A row may have
/// fewer cells than others.
std::string TableText(const Rows& rows);

}  // namespace thalweg::inspector
