#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "common/service/service.h"
#include "services/cli/command/command.h"
#include "services/cli/command/topic.h"
#include "services/inspector/adapter/gather_facts.h"
#include "services/inspector/core/findings.h"

namespace thalweg::cli {
namespace {

struct DoctorArgs {
  NetworkArgs network;
  std::string out = "runs";
  bool json = false;
  bool quiet = false;
};

int Examine(const DoctorArgs& args) {
  const std::stop_token stop = StopOnSignals();
  const auto facts = inspector::GatherFacts(SurveyOptionsFrom(args.network), args.out, stop);
  const std::vector<inspector::Finding> findings = inspector::Diagnose(facts);
  std::cout << (args.json ? inspector::FindingsJson(findings)
                          : inspector::FindingsText(findings, args.quiet));
  return inspector::HasProblem(findings) ? EXIT_FAILURE : EXIT_SUCCESS;
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
