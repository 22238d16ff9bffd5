#pragma once

#include <string>
#include <vector>

namespace thalweg {

/// "; did you mean closest?" if one of the names is nearly this one, else nothing.
std::string DidYouMean(const std::vector<std::string>& names, const std::string& name);

}  // namespace thalweg
