#pragma once

#include <string>
#include <vector>

#include "services/inspector/core/diagnosis.h"

namespace thalweg::inspector {

/// The findings as a JSON list with an object each, indented and with a line break at the end.
std::string FindingsJson(const std::vector<Finding>& findings);

/// The findings for people, a line each with the advice below it, and at the end how many problems and notes
/// there are.
/// @param quiet  Leave out what is ok.
std::string FindingsText(const std::vector<Finding>& findings, bool quiet);

bool HasProblem(const std::vector<Finding>& findings);  ///< Notes are none.

}  // namespace thalweg::inspector
