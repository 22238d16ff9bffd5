#pragma once

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

namespace thalweg::cli {

/// The numbers from `low` to `high`. CLI::Range takes "nan" for one of its own.
inline CLI::Validator NumberFrom(double low, double high) {
  const auto check = [low, high](const std::string& text) {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return std::string();
    std::ostringstream reason;
    reason << '"' << text << "\" is not a number from " << low << " to " << high;
    return reason.str();
  };
  return {check, CLI::Range(low, high).get_description(), ""};
}

}  // namespace thalweg::cli
