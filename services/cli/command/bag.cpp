#include <fmt/format.h>

#include <cstdio>
#include <iostream>
#include <limits>
#include <memory>
#include <stdexcept>

#include "common/base/megabytes.h"
#include "common/base/text.h"
#include "services/cli/command/command.h"
#include "services/cli/command/recording_args.h"
#include "services/cli/export/export.h"
#include "services/recorder/adapter/copy.h"
#include "services/recorder/adapter/describe.h"
#include "services/recorder/adapter/mapped_file.h"

namespace thalweg::cli {
namespace {

/// A recording, read where it lies.
class Recording {
 public:
  explicit Recording(const std::filesystem::path& file) : file_(file), reader_(Open(file)) {}
  const recorder::McapReader& reader() const { return reader_; }

 private:
  recorder::McapReader Open(const std::filesystem::path& name) const {
    auto reader = recorder::McapReader::Open(file_.bytes());
    if (!reader) throw std::runtime_error(name.string() + ": " + reader.error());
    return *std::move(reader);
  }
  recorder::MappedFile file_;
  recorder::McapReader reader_;
};

void AddBagInfo(CLI::App& bag, int& exit_code) {
  struct Args {
    std::filesystem::path file;
    bool check = false;
  };
  const auto args = std::make_shared<Args>();
  CLI::App* command = bag.add_subcommand("info", "Print what a recording holds, and what is damaged");
  command->add_option("file", args->file, "Recording")->required();
  command->add_flag("--check", args->check, "Read all of it and compare every CRC");
  command->callback([args, &exit_code] {
    const Recording recording(args->file);
    for (const std::string& line : recorder::Describe(recording.reader())) std::cout << line << '\n';
    exit_code = recording.reader().problems().empty() ? EXIT_SUCCESS : EXIT_FAILURE;
    if (!args->check) return;
    exit_code = ReportProblems(recording.reader().Check());
    if (exit_code == EXIT_SUCCESS) std::cout << "checked      every CRC is right\n";
  });
}

int Report(const recorder::Copied& copied) {
  fmt::print("{} messages, {}:", copied.messages, MegabytesText(static_cast<double>(copied.bytes)));
  for (const std::filesystem::path& file : copied.files) fmt::print(" {}", file.string());
  fmt::print("\n");
  std::fflush(stdout);
  return ReportProblems(copied.problems);
}

void AddBagCut(CLI::App& bag, int& exit_code) {
  struct Args {
    std::filesystem::path file;
    double start = 0.0;
    double end = std::numeric_limits<double>::infinity();
    recorder::Selection selection;
    recorder::RecordingOptions out;
  };
  const auto args = std::make_shared<Args>();
  CLI::App* command =
      bag.add_subcommand("cut", "Copy a part of a recording; also repairs one that is damaged");
  command->add_option("file", args->file, "Recording")->required();
  command->add_option("--start", args->start, "[s] After the first message")->capture_default_str();
  command->add_option("--end", args->end, "[s] After the first message; default: all");
  command->add_option("--topics", args->selection.topics, "Topics, separated by commas, or patterns")
      ->delimiter(',')
      ->allow_extra_args(false);
  AddRecordingArgs(*command, args->out);
  command->callback([args, &exit_code] {
    const Recording recording(args->file);
    if (!recording.reader().start()) throw std::runtime_error(args->file.string() + ": has no messages");
    const Time begin = *recording.reader().start();
    const Duration length = *recording.reader().end() - begin;
    if (!(args->start >= 0.0 && args->start < args->end)) {
      throw std::runtime_error("--start must be at least 0 and before --end");
    }
    if (args->start > Seconds(length)) {
      throw std::runtime_error("--start must be 0 to " + recorder::SecondsText(length) +
                               ", the recording's length");
    }
    args->selection.start = begin + FromSeconds(args->start);
    if (args->end <= Seconds(length)) args->selection.end = begin + FromSeconds(args->end);
    exit_code = Report(recorder::Copy({&recording.reader()}, args->selection, args->out));
  });
}

void AddBagMerge(CLI::App& bag, int& exit_code) {
  struct Args {
    std::vector<std::filesystem::path> files;
    recorder::RecordingOptions out;
  };
  const auto args = std::make_shared<Args>();
  CLI::App* command = bag.add_subcommand("merge", "Join recordings in order of their log times");
  command->add_option("files", args->files, "Recordings")->required();
  AddRecordingArgs(*command, args->out);
  command->callback([args, &exit_code] {
    std::vector<std::unique_ptr<Recording>> recordings;
    std::vector<const recorder::McapReader*> readers;
    std::vector<std::string> names;
    for (const auto& file : args->files) {
      recordings.push_back(std::make_unique<Recording>(file));
      readers.push_back(&recordings.back()->reader());
      names.push_back(file.string());
    }
    exit_code = Report(recorder::Copy(readers, {}, args->out, names));
  });
}

void AddBagExport(CLI::App& bag, int& exit_code) {
  struct Args {
    std::filesystem::path file;
    std::filesystem::path folder;
    recorder::Selection selection;
  };
  const auto args = std::make_shared<Args>();
  CLI::App* command =
      bag.add_subcommand("export", "Write files that other programs read: TUM, PLY, PNG, JSON lines");
  command->add_option("file", args->file, "Recording")->required();
  command->add_option("-o,--out", args->folder, "Folder of the files")->required();
  command->add_option("--topics", args->selection.topics, "Topics, separated by commas, or patterns")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->callback([args, &exit_code] {
    const Recording recording(args->file);
    const Exported exported = Export(recording.reader(), args->selection, args->folder);
    if (exported.topics.empty()) throw std::runtime_error(args->file.string() + ": has no such messages");
    exit_code = ReportProblems(exported.problems);
    for (const ExportedTopic& topic : exported.topics) {
      fmt::print("{:<28} {:>7} messages  {}\n", CleanText(topic.topic), topic.messages, topic.files);
      if (topic.left_out == 0) continue;
      fmt::print(stderr, "{}: {} messages were left out; the first: {}\n", CleanText(topic.topic),
                 topic.left_out, topic.reason);
      exit_code = EXIT_FAILURE;
    }
  });
}

}  // namespace

void AddBag(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("bag", "Look into recordings: info, cut, merge, export");
  command->require_subcommand(1);
  AddBagInfo(*command, exit_code);
  AddBagCut(*command, exit_code);
  AddBagMerge(*command, exit_code);
  AddBagExport(*command, exit_code);
}

}  // namespace thalweg::cli
