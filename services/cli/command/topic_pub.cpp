#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/base/ros_name.h"
#include "common/base/text.h"
#include "common/service/service.h"
#include "services/cli/command/number_range.h"
#include "services/cli/command/topic.h"
#include "services/inspector/adapter/survey.h"
#include "services/inspector/core/cdr.h"
#include "services/inspector/core/yaml.h"

namespace thalweg::cli {
namespace {

struct PubArgs {
  TopicArgs topic;
  std::string yaml;
  double rate_hz = 1.0;
  bool once = false;
  double patience_s = 20.0;
};

/// Waits until everybody on the bus is known, since whoever is matched later does not get the first message,
/// and somebody subscribes. Returns false if nobody does.
bool AwaitReaders(dds::Bus& bus, const dds::Bus::BytesPublisher& publisher, Duration patience,
                  const std::stop_token& stop) {
  inspector::Survey(bus, stop);
  const auto is_over = [&] { return stop.stop_requested() || publisher.readers() > 0; };
  if (!is_over()) {
    std::cerr << "nobody subscribes yet; waiting up to " << NumberText(Seconds(patience))
              << " s (--timeout)\n";
  }
  return bus.SpinUntil(is_over, patience);
}

/// A message may be longer than an argument can be. Read before signals are caught, so that Ctrl-C ends it.
std::string MessageFrom(const std::string& argument, std::istream& in) {
  if (argument != "-") return argument;
  std::ostringstream text;
  text << in.rdbuf();
  if (text.view().empty())
    throw std::runtime_error("the message is to come from standard input, which is empty");
  return std::move(text).str();
}

int Publish(const PubArgs& args) {
  const std::string yaml = MessageFrom(args.yaml, std::cin);
  const std::stop_token stop = StopOnSignals();
  dds::Bus bus(SurveyOptionsFrom(args.topic.network));
  const inspector::OpenTopic topic = OpenTopicFrom(args.topic, bus, stop);
  const auto encoded = [&] {
    const auto message = inspector::ParseYaml(topic.schema, yaml, bus.Now());
    if (!message) throw std::runtime_error("the message for " + topic.info.name + ": " + message.error());
    return inspector::EncodeCdr(topic.schema, *message);
  };
  encoded();  // a mistake is reported before anybody is waited for
  if (!IsRosName(topic.info.name)) {
    throw std::runtime_error(topic.info.name + " is not " + std::string(kRosNameRule));
  }
  const dds::Bus::BytesPublisher publisher = bus.AdvertiseBytes(topic.info);
  if (!AwaitReaders(bus, publisher, FromSeconds(args.patience_s), stop)) {
    throw std::runtime_error("nobody subscribes to " + topic.info.name);
  }
  std::uint64_t published = 0;
  const auto publish = [&] {
    if (publisher.Write(encoded())) ++published;
  };
  if (stop.stop_requested()) return EXIT_FAILURE;
  publish();
  if (!args.once) {
    bus.EveryWall(FromSeconds(1.0 / args.rate_hz), publish);
    bus.SpinUntil([&] { return stop.stop_requested(); }, std::chrono::hours(24 * 365));
  }
  const bool delivered = publisher.AwaitDelivery(FromSeconds(args.patience_s));
  const int readers = publisher.readers();
  std::cout << "published " << published << " to " << readers
            << (readers == 1 ? " subscriber" : " subscribers") << " of " << topic.info.name << std::endl;
  if (!delivered) throw std::runtime_error("not all subscribers confirmed the last message");
  return EXIT_SUCCESS;
}

}  // namespace

void AddTopicPub(CLI::App& topic, int& exit_code) {
  const auto args = std::make_shared<PubArgs>();
  CLI::App* const command =
      topic.add_subcommand("pub", "Publish a message given in YAML, once or again and again");
  AddTopicArgs(*command, args->topic);
  command
      ->add_option(
          "message", args->yaml,
          "Its fields, such as '{linear: {x: 0.5}}'; the others are zero; a stamp may be now; - reads "
          "them from standard input, as topic echo --full-length prints them")
      ->required();
  command->add_option("--rate", args->rate_hz, "[Hz]")
      ->check(NumberFrom(0.001, 10'000.0))
      ->capture_default_str();
  command->add_flag("--once", args->once, "Publish one message and end");
  command->add_option("--timeout", args->patience_s, "[s] Wait at most this long for a subscriber")
      ->check(NumberFrom(0.001, 1e9))
      ->capture_default_str();
  command->callback([args, &exit_code] { exit_code = Publish(*args); });
}

}  // namespace thalweg::cli
