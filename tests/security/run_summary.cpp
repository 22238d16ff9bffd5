// Prints what tests/security/attack needs of the report of a run, a line each with tabs in between: the
// reason for its end, coverage and agreement in percent, true collisions; then "refused", a topic and how
// many of its messages the services refused or dropped.
//
// usage: run_summary report.json

#include <cstdint>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace {

std::string Percent(const nlohmann::json& share) {
  if (!share.is_number()) return "-";
  const auto tenths = static_cast<int>(share.get<double>() * 1000.0);
  return std::to_string(tenths / 10) + '.' + std::to_string(tenths % 10);
}

}  // namespace

int main(int argc, char** argv) try {
  std::ifstream in(argc > 1 ? argv[1] : "");
  const auto report = nlohmann::json::parse(in);
  std::cout << "reason\t" << report.at("stop_reason").get<std::string>() << '\n'
            << "coverage\t" << Percent(report.at("coverage")) << '\n'
            << "agreement\t" << Percent(report.at("agreement")) << '\n'
            << "collisions\t" << report.at("true_collisions") << '\n';
  std::map<std::string, std::uint64_t> refused;
  for (const char* list : {"messages_rejected", "messages_dropped"}) {
    for (const auto& count : report.at(list).at("by_topic")) {
      refused[count.at("name").get<std::string>()] += count.at("count").get<std::uint64_t>();
    }
  }
  for (const auto& [topic, count] : refused) std::cout << "refused\t" << topic << '\t' << count << '\n';
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "run_summary: " << error.what() << '\n';
  return EXIT_FAILURE;
}
