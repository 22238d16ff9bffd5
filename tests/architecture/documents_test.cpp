#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace thalweg::test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = THALWEG_SOURCE_DIR;

std::vector<fs::path> Documents() {
  std::vector<fs::path> files;
  for (auto entry = fs::recursive_directory_iterator(kRoot); entry != fs::recursive_directory_iterator();
       ++entry) {
    const std::string name = entry->path().filename().string();
    if (entry->is_directory() && (name.starts_with(".") || name.starts_with("build") || name == "runs")) {
      entry.disable_recursion_pending();
    }
    if (entry->path().extension() == ".md") files.push_back(entry->path());
  }
  return files;
}

/// Calls check(line number, match) for each match of the pattern in a file.
template <class Check>
void ForEachMatch(const fs::path& file, const std::regex& pattern, Check&& check) {
  std::ifstream in(file);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    for (std::sregex_iterator match(line.begin(), line.end(), pattern), end; match != end; ++match) {
      check(file.string() + ':' + std::to_string(number), *match);
    }
  }
}

TEST(Documents, LinksLeadToFilesThatAreThere) {
  const std::regex link("\\]\\(([^)#]+)(#[^)]*)?\\)");
  int links = 0;
  for (const fs::path& file : Documents()) {
    ForEachMatch(file, link, [&](const std::string& place, const std::smatch& match) {
      if (match[1].str().find("://") != std::string::npos) return;
      ++links;
      EXPECT_TRUE(fs::exists(file.parent_path() / match[1].str())) << place << ": " << match[1];
    });
  }
  EXPECT_GT(links, 15);
}

TEST(Documents, ProgramsAndScriptsTheyNameAreThere) {
  std::ostringstream build_files;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "services")) {
    if (entry.path().filename() == "CMakeLists.txt") build_files << std::ifstream(entry.path()).rdbuf();
  }
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "tests")) {
    if (entry.path().filename() == "CMakeLists.txt") build_files << std::ifstream(entry.path()).rdbuf();
  }
  const std::string targets = build_files.str();
  const std::regex program("build/bin/([a-z_-]+)");
  const std::regex script("(?:^|[ `(])((?:deploy|docs|tests)/[a-z][a-z_/-]*)(?![a-z_/.*-])");
  for (const fs::path& file : Documents()) {
    ForEachMatch(file, program, [&](const std::string& place, const std::smatch& match) {
      const std::string name = match[1];
      // thalweg-mapper: thalweg_add_service(mapper ...; test_dds: thalweg_add_test(dds ...; bench_field
      // likewise
      const std::regex target("add_executable\\(" + name + "\\b|" +
                              std::regex_replace(name, std::regex("^(?:thalweg-|test_|bench_)(.*)$"),
                                                 "thalweg_add_(?:service|test|benchmark)\\($1\\b"));
      EXPECT_TRUE(std::regex_search(targets, target)) << place << ": " << match[0];
    });
    ForEachMatch(file, script, [&](const std::string& place, const std::smatch& match) {
      EXPECT_TRUE(fs::exists(kRoot / match[1].str())) << place << ": " << match[1];
    });
  }
}

// `core/track.h` in a service's own README, `common/dds/topics.h` or `explorer/core/map/frontier.h` anywhere.
TEST(Documents, SourceFilesTheyNameAreThere) {
  const std::regex source("`((?:[a-z0-9_]+/)+[a-z0-9_]+\\.(?:h|cpp|proto|idl))`");
  int files = 0;
  for (const fs::path& file : Documents()) {
    if (file.filename() == "CHANGELOG.md") continue;  // which names what was there
    ForEachMatch(file, source, [&](const std::string& place, const std::smatch& match) {
      ++files;
      const std::string name = match[1];
      EXPECT_TRUE(fs::exists(file.parent_path() / name) || fs::exists(kRoot / name) ||
                  fs::exists(kRoot / "services" / name))
          << place << ": " << name;
    });
  }
  EXPECT_GT(files, 50);
}

// A README introduces; measurements, decisions and longer how-tos have places of their own under docs/.
TEST(Documents, ReadmesFitOnAPage) {
  constexpr int kMostLines = 85;
  for (const fs::path& file : Documents()) {
    if (file.filename() != "README.md") continue;
    std::ifstream in(file);
    int lines = 0;
    for (std::string line; std::getline(in, line);) ++lines;
    EXPECT_LE(lines, kMostLines) << file;
  }
}

TEST(Documents, DecisionsAreNumberedWithoutGapsAndSayContextDecisionAndConsequences) {
  std::set<std::string> numbers;
  for (const auto& entry : fs::directory_iterator(kRoot / "docs" / "decisions")) {
    numbers.insert(entry.path().filename().string().substr(0, 4));
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    for (const char* heading : {"\n## Context\n", "\n## Decision\n", "\n## Consequences\n"}) {
      EXPECT_NE(text.str().find(heading), std::string::npos) << entry.path() << ": no" << heading;
    }
  }
  ASSERT_FALSE(numbers.empty());
  EXPECT_EQ(std::stoul(*numbers.rbegin()), numbers.size());
}

TEST(Documents, EachOfThemIsReachedFromTheIndex) {
  std::ostringstream index;
  index << std::ifstream(kRoot / "docs" / "README.md").rdbuf();
  for (const char* folder : {"guide", "results", "decisions"}) {
    for (const auto& entry : fs::directory_iterator(kRoot / "docs" / folder)) {
      const std::string link = std::string("](") + folder + '/' + entry.path().filename().string() + ')';
      EXPECT_NE(index.str().find(link), std::string::npos) << "docs/README.md has no link " << link;
    }
  }
}

TEST(Documents, HaveNoPlaceholders) {
  const std::regex placeholder("\\b(TODO|TBD|FIXME|XXX|placeholder|lorem)\\b", std::regex::icase);
  for (const fs::path& file : Documents()) {
    ForEachMatch(file, placeholder, [](const std::string& place, const std::smatch& match) {
      ADD_FAILURE() << place << ": " << match[0];
    });
  }
}

TEST(Documents, EveryServiceAndTheHarderPartsOfCommonHaveOne) {
  for (const char* folder : {"common/dds", "common/scenario", "docs", "services/cli", "services/controller",
                             "services/explorer", "services/mapper", "services/simulator", "deploy"}) {
    EXPECT_TRUE(fs::exists(kRoot / folder / "README.md")) << folder;
  }
}

}  // namespace
}  // namespace thalweg::test
