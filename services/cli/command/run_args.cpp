#include "services/cli/command/run_args.h"

#include "services/cli/command/network_args.h"

namespace thalweg::cli {

void AddRunArgs(CLI::App& command, RunArgs& args) {
  command.add_option("scenario", args.scenario, "Scenario: a name that thalweg scenarios lists, or a file")
      ->envname("THALWEG_SCENARIO")
      ->capture_default_str();
  command.add_option("--out", args.out, "Folder for the files of the run; default: runs/SCENARIO-DATE-TIME");
  command
      .add_option("--set", args.overrides,
                  "Override a field of the scenario, e.g. mapper.voxel_size_m=0.05; may be repeated")
      ->allow_extra_args(false);
  AddDomainOption(command, args.domain, ". Simultaneous runs need different ones");
  command.add_flag("--json", args.json,
                   "Print JSON for programs instead of text, one object a line: {\"event\": ...}");
}

}  // namespace thalweg::cli
