#include "tests/architecture/sources.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>

#include "tests/support/places.h"

namespace thalweg::test {
namespace {

namespace fs = std::filesystem;

/// The k-th part of a path under services/.
std::string PartOf(const std::string& path, std::ptrdiff_t k) {
  const fs::path whole(path);
  if (!path.starts_with("services/") || std::distance(whole.begin(), whole.end()) <= k) return "";
  return std::next(whole.begin(), k)->string();
}

}  // namespace

std::string Source::IncludeIn(const std::string& line) {
  static const std::regex kInclude("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"]");
  std::smatch match;
  return std::regex_search(line, match, kInclude) ? match[1].str() : "";
}

std::vector<Source> SourcesUnder(const std::string& folder) {
  const fs::path root = SourceFolder();
  static const std::regex kComment("(^|\\s)//.*$");
  std::vector<Source> sources;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    Source& source = sources.emplace_back();
    source.path = fs::relative(entry.path(), root).string();
    std::ifstream stream(entry.path());
    for (std::string line; std::getline(stream, line);) {
      source.lines.push_back(std::regex_replace(line, kComment, ""));
    }
  }
  std::sort(sources.begin(), sources.end(), [](const Source& a, const Source& b) { return a.path < b.path; });
  return sources;
}

std::string ServiceOf(const std::string& path) {
  return PartOf(path, 1);
}

std::string LayerOf(const std::string& path) {
  return PartOf(path, 2);
}

}  // namespace thalweg::test
