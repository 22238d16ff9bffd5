#include <gtest/gtest.h>

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/architecture/sources.h"

namespace thalweg::test {
namespace {

/// Core contains only algorithms, which run equally in a service, in the evaluator and in a test.
bool IsPure(const Source& source) {
  return LayerOf(source.path) == "core" || LayerOf(source.path) == "text" ||
         source.path.starts_with("common/base/") || source.path.starts_with("common/compression/") ||
         source.path.starts_with("common/geometry/") || source.path.starts_with("common/camera/") ||
         source.path.starts_with("common/surface_graph/") || source.path.starts_with("common/voxel/");
}

/// These services combine several others, in one process and as processes.
bool Composes(const std::string& service) {
  return service == "cli" || service == "evaluator";
}

std::vector<Source> AllSources() {
  std::vector<Source> sources = SourcesUnder("common");
  for (Source& source : SourcesUnder("services")) sources.push_back(std::move(source));
  return sources;
}

/// Calls check(source, line number, included path) for each #include of our own code.
template <class Check>
void ForEachInclude(Check&& check) {
  for (const Source& source : AllSources()) {
    for (std::size_t line = 0; line < source.lines.size(); ++line) {
      const std::string included = Source::IncludeIn(source.lines[line]);
      if (!included.empty()) check(source, line, included);
    }
  }
}

TEST(Layers, TheRepositoryIsReallyRead) {
  const std::vector<Source> sources = AllSources();
  EXPECT_GT(std::count_if(sources.begin(), sources.end(), IsPure), 20);
  EXPECT_EQ(Source::IncludeIn("#include <fstream>"), "fstream");
  EXPECT_EQ(Source::IncludeIn("  # include \"a/b.h\""), "a/b.h");
  EXPECT_EQ(ServiceOf("services/mapper/core/x.h"), "mapper");
  EXPECT_EQ(LayerOf("services/mapper/core/x.h"), "core");
  EXPECT_EQ(ServiceOf("common/dds/bus.h"), "");
}

TEST(Layers, CoreIncludesNoDdsNoProtobufAndNoFiles) {
  const std::regex forbidden(
      "^(fastdds|fastrtps|fastcdr|dds|google/protobuf)/|PubSubTypes\\.h$|_msgs\\.h$|\\.pb\\.h$|"
      "^common/(dds|scenario|service)/|/adapter/|^(fstream|filesystem|iostream)$|^opencv2/"
      "(imgcodecs|highgui)|"
      "^spdlog/|^CLI/");
  ForEachInclude([&](const Source& source, std::size_t line, const std::string& included) {
    if (!IsPure(source)) return;
    EXPECT_FALSE(std::regex_search(included, forbidden)) << source.At(line) << " includes " << included;
  });
}

TEST(Layers, CoreNeverAsksForTheTimeOfDay) {
  const std::regex forbidden(
      "system_clock::now|high_resolution_clock|gettimeofday|clock_gettime|std::time\\(");
  for (const Source& source : AllSources()) {
    if (!IsPure(source)) continue;
    for (std::size_t line = 0; line < source.lines.size(); ++line) {
      EXPECT_FALSE(std::regex_search(source.lines[line], forbidden)) << source.At(line);
    }
  }
}

TEST(Layers, CommonIncludesNoServiceAndOnlyWhatLiesBelowIt) {
  // As in the top CMakeLists.txt, from the bottom up.
  const std::vector<std::string> order = {"base",  "compression", "geometry", "camera", "surface_graph",
                                          "voxel", "files",       "drawing",  "scenario", "dds", "service"};
  const auto rank = [&](const std::string& path) {
    const std::string name = path.substr(7, path.find('/', 7) - 7);
    return std::find(order.begin(), order.end(), name) - order.begin();
  };
  ForEachInclude([&](const Source& source, std::size_t line, const std::string& included) {
    if (!source.path.starts_with("common/")) return;
    EXPECT_FALSE(included.starts_with("services/")) << source.At(line) << " includes " << included;
    if (!included.starts_with("common/")) return;
    EXPECT_LE(rank(included), rank(source.path)) << source.At(line) << " includes " << included;
  });
}

TEST(Layers, ServicesDoNotIncludeEachOther) {
  ForEachInclude([](const Source& source, std::size_t line, const std::string& included) {
    const std::string service = ServiceOf(source.path);
    const std::string other = ServiceOf(included);
    if (service.empty() || other.empty() || Composes(service)) return;
    EXPECT_EQ(other, service) << source.At(line) << " includes " << included;
  });
}

/// The folders of the explorer's core, from the bottom up; core/ itself contains the loop on top of them.
const std::vector<std::string> kExplorerRooms = {"map", "path", "view", "field", "gaps", "strategy", "core"};
int ExplorerRoom(const std::string& path) {
  const std::string core = "services/explorer/core/";
  if (!path.starts_with(core)) return -1;
  const std::string rest = path.substr(core.size());
  const std::size_t slash = rest.find('/');
  const std::string name = slash == std::string::npos ? kExplorerRooms.back() : rest.substr(0, slash);
  const auto room = std::find(kExplorerRooms.begin(), kExplorerRooms.end(), name);
  EXPECT_NE(room, kExplorerRooms.end()) << path << " stands in a room that has no place in the order";
  return static_cast<int>(room - kExplorerRooms.begin());
}

TEST(Layers, RoomsOfTheExplorerIncludeOnlyWhatLiesBelowThem) {
  std::map<std::pair<int, int>, int> includes;  // from a room, of a room
  ForEachInclude([&](const Source& source, std::size_t line, const std::string& included) {
    if (!source.path.starts_with("services/explorer/core/") || !included.starts_with("services/")) return;
    ++includes[{ExplorerRoom(source.path), ExplorerRoom(included)}];
    EXPECT_GE(ExplorerRoom(included), 0) << source.At(line) << " includes " << included;
    EXPECT_LE(ExplorerRoom(included), ExplorerRoom(source.path))
        << source.At(line) << " includes " << included;
    // Field and gaps are mathematics in their own right: they know neither map nor path nor view.
    for (const std::string alone : {"services/explorer/core/field/", "services/explorer/core/gaps/"}) {
      if (!source.path.starts_with(alone)) continue;
      EXPECT_TRUE(included.starts_with(alone)) << source.At(line) << " includes " << included;
    }
  });
  int down = 0;
  int up = 0;
  std::cout << std::setw(10) << "includes"
            << " of:";
  for (const std::string& room : kExplorerRooms) std::cout << std::setw(9) << room;
  for (std::size_t from = 0; from < kExplorerRooms.size(); ++from) {
    std::cout << '\n' << std::setw(10) << kExplorerRooms[from] << "    ";
    for (std::size_t to = 0; to < kExplorerRooms.size(); ++to) {
      const int count = includes[{static_cast<int>(from), static_cast<int>(to)}];
      std::cout << std::setw(9) << count;
      if (from != to) (to < from ? down : up) += count;
    }
  }
  std::cout << '\n' << down << " from room to room go down, " << up << " up\n";
  EXPECT_GT(down, 50);
  EXPECT_EQ(up, 0);
}

TEST(Layers, FastDdsStandsOnlyInCommonDds) {
  const std::regex forbidden("^(fastdds|fastrtps|fastcdr)/");
  const std::regex name(
      "\\b(DomainParticipant|DataWriterQos|DataReaderQos|TopicQos|PublisherQos|SubscriberQos)");
  for (const Source& source : AllSources()) {
    if (source.path.starts_with("common/dds/")) continue;
    for (std::size_t line = 0; line < source.lines.size(); ++line) {
      EXPECT_FALSE(std::regex_search(Source::IncludeIn(source.lines[line]), forbidden)) << source.At(line);
      EXPECT_FALSE(std::regex_search(source.lines[line], name)) << source.At(line);
    }
  }
}

TEST(Layers, TopicNamesStandOnlyInTheTableOfTopics) {
  const std::string table = "common/dds/topics.h";
  const std::regex declaration("kName = \"([^\"]+)\"");
  std::set<std::string> literals;
  for (const Source& source : SourcesUnder("common/dds")) {
    if (source.path != table) continue;
    for (const std::string& line : source.lines) {
      std::smatch match;
      if (std::regex_search(line, match, declaration)) literals.insert('"' + match[1].str() + '"');
    }
  }
  ASSERT_GT(literals.size(), 10U);
  for (const Source& source : AllSources()) {
    if (source.path == table) continue;
    for (std::size_t line = 0; line < source.lines.size(); ++line) {
      // A command or a choice on the command line may have the name of a topic.
      if (source.lines[line].find("add_subcommand(") != std::string::npos ||
          source.lines[line].find("PoseSource::") != std::string::npos) {
        continue;
      }
      for (const std::string& literal : literals) {
        EXPECT_EQ(source.lines[line].find(literal), std::string::npos)
            << source.At(line) << " says " << literal;
      }
      const bool names_one = source.lines[line].find("\"rt/") != std::string::npos;
      EXPECT_TRUE(!names_one || source.path.starts_with("common/dds/")) << source.At(line);
    }
  }
}

}  // namespace
}  // namespace thalweg::test
