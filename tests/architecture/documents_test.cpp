#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "common/dds/topic_table.h"
#include "tests/architecture/sources.h"

namespace thalweg::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> Documents() {
  std::vector<fs::path> files;
  for (auto entry = fs::recursive_directory_iterator(kRoot); entry != fs::recursive_directory_iterator();
       ++entry) {
    const std::string name = entry->path().filename().string();
    if (entry->is_directory() &&
        (name.starts_with(".") || name.starts_with("build") || name == "runs" || name == "node_modules")) {
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
      const std::string target = match[1];
      // [&](const Path& path) in an example of code is no link.
      if (target.find("://") != std::string::npos || target.find(' ') != std::string::npos) return;
      ++links;
      EXPECT_TRUE(fs::exists(file.parent_path() / target)) << place << ": " << target;
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

/// "suite.name" of each test and "name." of each test program, which is what tests/run --only searches.
std::vector<std::string> NamesOfTests() {
  std::vector<std::string> names;
  const std::regex test("\\bTEST(?:_F|_P)?\\(\\s*(\\w+),\\s*(\\w+)\\)");
  const std::regex program("thalweg_add_(?:script_)?test\\(([\\w.]+)");
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "tests")) {
    const bool source = entry.path().extension() == ".cpp";
    if (!source && entry.path().filename() != "CMakeLists.txt") continue;
    std::ostringstream out;
    out << std::ifstream(entry.path()).rdbuf();
    const std::string text = out.str();
    const std::regex& pattern = source ? test : program;
    for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) {
      names.push_back((*match)[1].str() + '.' + (source ? (*match)[2].str() : ""));
    }
  }
  return names;
}

TEST(Documents, TestsTheyNameAreThere) {
  const std::vector<std::string> names = NamesOfTests();
  ASSERT_GT(names.size(), 500U);
  const auto is_there = [&](const std::regex& pattern) {
    return std::ranges::any_of(names,
                               [&](const std::string& name) { return std::regex_search(name, pattern); });
  };
  const std::regex only("--only (?:'([^']+)'|(\\w*[a-z]\\w*))");
  const std::regex filter("--gtest_filter='([^']+)'");
  int commands = 0;
  for (const fs::path& file : Documents()) {
    ForEachMatch(file, only, [&](const std::string& place, const std::smatch& match) {
      ++commands;
      // In a table, the bar of a regular expression is escaped.
      const std::string each =
          std::regex_replace(match[1].str() + match[2].str(), std::regex("\\\\\\|"), "|");
      std::istringstream alternatives(each);
      for (std::string alternative; std::getline(alternatives, alternative, '|');) {
        EXPECT_TRUE(is_there(std::regex(alternative))) << place << ": " << alternative;
      }
    });
    ForEachMatch(file, filter, [&](const std::string& place, const std::smatch& match) {
      ++commands;
      std::istringstream alternatives(match[1].str());
      for (std::string glob; std::getline(alternatives, glob, ':');) {
        const std::string pattern = std::regex_replace(glob, std::regex("\\*"), ".*");
        EXPECT_TRUE(is_there(std::regex('^' + pattern + '$'))) << place << ": " << glob;
      }
    });
  }
  EXPECT_GT(commands, 20);
}

// `core/track.h` in a service's own README; `common/dds/topics.h` or `explorer/core/map/frontier.h` anywhere.
TEST(Documents, SourceFilesTheyNameAreThere) {
  const std::regex source("`((?:[a-z0-9_]+/)+[a-z0-9_]+\\.(?:h|cpp|proto|idl))`");
  int files = 0;
  for (const fs::path& file : Documents()) {
    if (file.filename() == "CHANGELOG.md") continue;  // since it names files of the past
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

// A README introduces; measurements, decisions and longer how-tos have their own places under docs/.
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

TEST(Documents, TheGuideForOutsideToolsSaysHowEachTopicIsDelivered) {
  const std::map<dds::Delivery, std::string> rows = {
      {dds::Delivery::kStream, "stream"}, {dds::Delivery::kSamples, "samples"},
      {dds::Delivery::kLog, "log"},       {dds::Delivery::kState, "state"},
      {dds::Delivery::kDiary, "diary"},   {dds::Delivery::kCommand, "command"},
      {dds::Delivery::kFrames, "frames"}};
  std::map<std::string, std::string> table;
  std::ifstream guide(SourceFolder() + "/docs/guide/outside-tools.md");
  for (std::string line; std::getline(guide, line);) {
    for (const auto& [delivery, name] : rows) {
      if (line.starts_with("| " + name + " |")) table[name] = line;
    }
  }
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    const std::string either =
        std::regex_replace(topic.name, std::regex("^stereo/(left|right)/"), "stereo/*/");
    EXPECT_THAT(table[rows.at(topic.delivery)], testing::HasSubstr("`" + either + "`")) << topic.name;
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
  std::vector<fs::path> folders = {"common/dds", "common/scenario", "deploy", "docs", "tests"};
  for (const auto& entry : fs::directory_iterator(kRoot / "services")) {
    if (entry.is_directory()) folders.push_back(fs::relative(entry.path(), kRoot));
  }
  EXPECT_GT(folders.size(), 15U);
  for (const fs::path& folder : folders) EXPECT_TRUE(fs::exists(kRoot / folder / "README.md")) << folder;
}

// A reader of one line sees what it is about; "Of the last plan" alone does not say what is.
TEST(Comments, StandAloneWithoutBeginningWithOf) {
  const std::regex fragment(R"(//[/<]*( \[[^\]]*\])? Of |@param \w+ +(\[[^\]]*\] )?(Of|That) |)"
                            R"(///<( \[[^\]]*\])? (That|Which was|And|Or|Because of) )");
  int files = 0;
  for (const char* const part : {"common", "idl", "services", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / part)) {
      const fs::path file = fs::relative(entry.path(), kRoot);
      const std::string kind = file.extension().string();
      if (kind != ".h" && kind != ".cpp" && kind != ".proto" && kind != ".idl") continue;
      ++files;
      ForEachMatch(entry.path(), fragment, [](const std::string& place, const std::smatch& match) {
        ADD_FAILURE() << place << ": " << match[0];
      });
    }
  }
  EXPECT_GT(files, 500);
}

TEST(Documents, HaveNoLongLinesInTheirText) {
  constexpr std::size_t kMost = 130;
  for (const fs::path& file : Documents()) {
    std::ifstream in(file);
    bool is_sample = false;
    int number = 0;
    for (std::string line; std::getline(in, line);) {
      ++number;
      if (line.find("```") != std::string::npos) is_sample = !is_sample;
      const bool is_table_or_picture = line.starts_with('|') || line.starts_with("![");
      if (is_sample || is_table_or_picture) continue;
      EXPECT_LE(line.size(), kMost) << file << ':' << number;
    }
  }
}

}  // namespace
}  // namespace thalweg::test
