#include "services/cli/command/recording_args.h"

#include <cstdlib>
#include <iostream>

#include "common/base/megabytes.h"
#include "common/base/text.h"
#include "common/service/command_line.h"
#include "services/cli/command/number_range.h"

namespace thalweg::cli {

void AddRecordingArgs(CLI::App& command, recorder::RecordingOptions& options) {
  command.add_option("-o,--out", options.file, "File to write; must not exist yet")->required();
  const NamedValues<Compression> compressions = {
      {"zstd", Compression::kZstd}, {"lz4", Compression::kLz4}, {"none", Compression::kNone}};
  command
      .add_option("--compression", options.compression,
                  "zstd, lz4 or none; default: " + NameAmong(compressions, options.compression))
      ->transform(OneOf(compressions))
      ->type_name("NAME");
  command
      .add_option_function<double>(
          "--split-size",
          [&options](double megabytes) { options.split_bytes = BytesFromMegabytes(megabytes); },
          "[MB] Begin another file when one has reached this size")
      ->check(NumberFrom(0.001, 1e9));
  command
      .add_option_function<double>(
          "--split-seconds", [&options](double seconds) { options.split_after = FromSeconds(seconds); },
          "[s] Begin another file when one spans this time")
      ->check(NumberFrom(0.001, 1e9));
}

int ReportProblems(const recorder::Problems& problems) {
  for (const std::string& text : problems.texts()) std::cerr << "thalweg: " << CleanText(text) << '\n';
  const std::size_t more = problems.count() - problems.texts().size();
  if (more > 0) std::cerr << "thalweg: and " << more << " more\n";
  return problems.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace thalweg::cli
