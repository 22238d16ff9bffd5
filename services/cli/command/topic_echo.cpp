#include <iostream>
#include <limits>
#include <memory>
#include <stdexcept>

#include "common/service/service.h"
#include "services/cli/command/command.h"
#include "services/cli/command/number_range.h"
#include "services/cli/command/topic.h"
#include "services/inspector/adapter/mistake_report.h"
#include "services/inspector/adapter/topic_listener.h"
#include "services/inspector/core/field_path.h"
#include "services/inspector/core/one_line.h"
#include "services/inspector/core/yaml.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

struct EchoArgs {
  TopicArgs topic;
  std::string field;
  bool once = false, csv = false, line = false, no_arrays = false, full_length = false;
  std::size_t most_elements = inspector::PrintOptions{}.most_elements;
  double timeout_s = std::numeric_limits<double>::infinity();
};

inspector::PrintOptions PrintOptionsFrom(const EchoArgs& args) {
  if (args.full_length) return inspector::PrintOptions::Everything();
  return {.most_elements = args.most_elements, .arrays = !args.no_arrays};
}

std::string Shown(const EchoArgs& args, const inspector::Schema& schema, const inspector::FieldType& type,
                  const inspector::Value& value) {
  if (args.csv) {
    const auto arrays = args.no_arrays ? inspector::Arrays::kLeftOut : inspector::Arrays::kWhole;
    return inspector::ToCsv(schema, type, value, arrays) + '\n';
  }
  if (args.line) return inspector::ToLine(schema, type, value) + '\n';
  return inspector::ToYaml(schema, type, value, PrintOptionsFrom(args)) + "---\n";
}

int Echo(const EchoArgs& args) {
  EndWithReader();
  const std::stop_token stop = StopOnSignals();
  dds::Bus bus(SurveyOptionsFrom(args.topic.network));
  const inspector::OpenTopic topic = OpenTopicFrom(args.topic, bus, stop);
  const auto field = inspector::FieldPath::Parse(topic.schema, args.field);
  if (!field) throw std::runtime_error(topic.info.name + ": " + field.error());

  std::uint64_t shown = 0;
  std::uint64_t without_part = 0;
  const auto print = [&](const inspector::Value& message, const dds::RawSample&) {
    if (args.once && shown + without_part > 0) return;
    const auto part = field->In(message);
    ++(part ? shown : without_part);
    if (!part) {
      std::cerr << "thalweg: " << topic.info.name << ": " << part.error() << std::endl;
      return;
    }
    std::cout << Shown(args, topic.schema, field->type(), *part) << std::flush;
  };
  inspector::TopicListener listener(bus, topic, print);
  inspector::MistakeReport mistakes(
      listener, [](const std::string& text) { std::cerr << "thalweg: " << text << std::endl; });
  bool asked = false;
  bus.EveryWall(3s, [&] {
    if (listener.received() == 0 && !asked) {
      std::cerr << "thalweg: " << inspector::WhyNothingArrives(topic.info.name, bus.Graph()) << std::endl;
    }
    asked = true;
  });
  bus.EveryWall(100ms, [] {});  // so that a stop is seen
  const auto is_over = [&] {
    mistakes.Look();
    return stop.stop_requested() || !std::cout || (args.once && listener.received() > 0);
  };
  bus.SpinUntil(is_over, FromSeconds(std::min(args.timeout_s, Seconds(kForEver))));
  if (listener.received() == 0 && !stop.stop_requested()) {
    throw std::runtime_error("no message of " + topic.info.name + " within --timeout");
  }
  const bool shows_nothing = shown == 0 && without_part > 0;
  return listener.malformed() == 0 && !shows_nothing ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

void AddTopicEcho(CLI::App& topic, int& exit_code) {
  const auto args = std::make_shared<EchoArgs>();
  CLI::App* const command = topic.add_subcommand("echo", "Print the messages of a topic, in YAML");
  AddTopicArgs(*command, args->topic);
  command->add_option("--field", args->field, "Print a part, such as pose.pose.position or poses[0].header");
  command->add_flag("--once", args->once, "Print one message and end");
  CLI::Option* const csv = command->add_flag(
      "--csv", args->csv, "Values separated by commas, a line a message, with whole arrays");
  command->add_flag("--line", args->line, "For people: a line a message")->excludes(csv);
  command->add_flag("--no-arr", args->no_arrays,
                    "Print the type and length of arrays only, with --csv nothing of them");
  command->add_option("--truncate-length", args->most_elements, "Elements of an array that are printed")
      ->excludes(csv)
      ->capture_default_str();
  command->add_flag("--full-length", args->full_length, "Print all elements of arrays");
  command->add_option("--timeout", args->timeout_s, "[s] End after this time; with 1 if no message came")
      ->check(NumberFrom(0.001, 1e9));
  command->callback([args, &exit_code] { exit_code = Echo(*args); });
}

}  // namespace thalweg::cli
