#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>

namespace thalweg::cli {

// CLI11's own checks take "nan" for a number of every range, and "inf" for one that is positive.

/// The finite numbers that `allows` accepts.
/// @param complaint  About a text that is none of them.
/// @param name       In the help.
inline CLI::Validator NumberThat(const std::function<bool(double)>& allows,
                                 const std::function<std::string(const std::string&)>& complaint,
                                 const std::string& name) {
  const auto check = [allows, complaint](const std::string& text) {
    double value = 0.0;
    const bool is_good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && allows(value);
    return is_good ? std::string() : complaint(text);
  };
  return {check, name};
}

/// The numbers from `low` to `high`.
inline CLI::Validator NumberFrom(double low, double high) {
  const auto complaint = [low, high](const std::string& text) {
    std::ostringstream reason;
    reason << '"' << text << "\" is not a number from " << low << " to " << high;
    return reason.str();
  };
  return NumberThat([low, high](double value) { return value >= low && value <= high; }, complaint,
                    CLI::Range(low, high).get_description());
}

inline CLI::Validator NotNegative() {
  return NumberThat([](double value) { return value >= 0.0; },
                    [](const std::string& text) { return "is " + text + ", must be a number >= 0"; },
                    "NONNEGATIVE");
}

inline CLI::Validator Positive() {
  return NumberThat([](double value) { return value > 0.0; },
                    [](const std::string& text) { return "is " + text + ", must be a number > 0"; },
                    "POSITIVE");
}

}  // namespace thalweg::cli
