#pragma once

#include <string_view>

namespace thalweg::cli {

// Files of services/cli/page and the gateway's page that a page written here contains, put into the program
// by the build. They do not contain "</script" or "</style".
extern const std::string_view kEvaluationStyle;
extern const std::string_view kEvaluationScript;

}  // namespace thalweg::cli
