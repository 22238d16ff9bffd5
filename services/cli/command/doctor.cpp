#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/service/service.h"
#include "services/cli/command/command.h"
#include "services/cli/command/topic.h"
#include "services/inspector/adapter/gather_facts.h"

namespace thalweg::cli {
namespace {

struct DoctorArgs {
  NetworkArgs network;
  std::string out = "runs";
  bool json = false;
  bool quiet = false;
};

void PrintAsJson(const std::vector<inspector::Finding>& findings) {
  nlohmann::json list = nlohmann::json::array();
  for (const inspector::Finding& finding : findings) {
    list.push_back({{"level", inspector::NameOf(finding.level)},
                    {"subject", finding.subject},
                    {"text", finding.text},
                    {"advice", finding.advice}});
  }
  std::cout << list.dump(2) << '\n';
}

void PrintForPeople(const std::vector<inspector::Finding>& findings, bool quiet) {
  int problems = 0;
  int notes = 0;
  for (const inspector::Finding& finding : findings) {
    problems += finding.level == inspector::Level::kProblem ? 1 : 0;
    notes += finding.level == inspector::Level::kNote ? 1 : 0;
    if (quiet && finding.level == inspector::Level::kOk) continue;
    std::cout << fmt::format("{:<8} {:<15} {}\n", inspector::NameOf(finding.level), finding.subject,
                             finding.text);
    if (!finding.advice.empty()) std::cout << fmt::format("{:>24} -> {}\n", "", finding.advice);
  }
  std::cout << fmt::format("{} problem{}, {} note{}\n", problems, problems == 1 ? "" : "s", notes,
                           notes == 1 ? "" : "s");
}

int Examine(const DoctorArgs& args) {
  const std::stop_token stop = StopOnSignals();
  const auto facts = inspector::GatherFacts(SurveyOptionsFrom(args.network), args.out, stop);
  const std::vector<inspector::Finding> findings = inspector::Diagnose(facts);
  args.json ? PrintAsJson(findings) : PrintForPeople(findings, args.quiet);
  const auto is_problem = [](const inspector::Finding& finding) {
    return finding.level == inspector::Level::kProblem;
  };
  return std::ranges::any_of(findings, is_problem) ? EXIT_FAILURE : EXIT_SUCCESS;
}

}  // namespace

void AddDoctor(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<DoctorArgs>();
  CLI::App* const command = app.add_subcommand(
      "doctor", "Look for what keeps processes from hearing each other, and say what to type");
  command->add_option("--out", args->out, "Folder in which runs leave their files")->capture_default_str();
  command->add_flag("--json", args->json, "Print the findings as JSON");
  command->add_flag("-q,--quiet", args->quiet, "Leave out what is well");
  AddNetworkArgs(*command, args->network);
  command->footer("Exits with 1 if there is a problem; a note is worth knowing, and may be well as it is.");
  command->callback([args, &exit_code] { exit_code = Examine(*args); });
}

}  // namespace thalweg::cli
