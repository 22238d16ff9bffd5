#include <algorithm>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>

#include "common/service/service.h"
#include "services/cli/command/command.h"
#include "services/cli/command/number_range.h"
#include "services/cli/command/topic.h"
#include "services/inspector/adapter/delay_listener.h"
#include "services/inspector/core/meters.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

struct MeterArgs {
  TopicArgs topic;
  std::size_t window = 0;
  double seconds = std::numeric_limits<double>::infinity();
  bool machine_clock = false;  ///< For delays.
};

using MeterReport = std::function<std::optional<std::string>()>;

/// Prints a report each second until it is stopped; returns the exit code.
int PrintReports(dds::Bus& bus, const MeterArgs& args, const std::string& topic, const std::stop_token& stop,
                 const std::function<std::uint64_t()>& received, const MeterReport& report) {
  EndWithReader();
  inspector::ArrivalWatch watch;
  bus.EveryWall(1s, [&] {
    switch (watch.Look(received())) {
      case inspector::ArrivalWatch::Finding::kNew:
        if (const auto text = report()) std::cout << *text << std::endl;
        break;
      case inspector::ArrivalWatch::Finding::kNone:
        break;
      case inspector::ArrivalWatch::Finding::kSilent:
        std::cerr << "thalweg: no new messages: " << inspector::WhyNothingArrives(topic, bus.Graph())
                  << std::endl;
        break;
    }
  });
  bus.EveryWall(100ms, [] {});  // so that a stop is seen
  bus.SpinUntil([&] { return stop.stop_requested() || !std::cout; },
                FromSeconds(std::min(args.seconds, Seconds(kForEver))));
  if (received() > 0) return EXIT_SUCCESS;
  std::cerr << "thalweg: no message of " << topic << " came\n";
  return EXIT_FAILURE;
}

/// Rate and bandwidth need no message decoded.
template <class Meter, class Add>
int Measure(const MeterArgs& args, Add&& add) {
  const std::stop_token stop = StopOnSignals();
  dds::Bus bus(SurveyOptionsFrom(args.topic.network));
  const inspector::OpenTopic topic = OpenTopicFrom(args.topic, bus, stop);
  Meter meter(args.window);
  std::uint64_t received = 0;
  bus.SubscribeBytes(topic.info, [&](const dds::RawSample& sample) {
    ++received;
    add(meter, sample);
  });
  return PrintReports(
      bus, args, topic.info.name, stop, [&] { return received; }, [&] { return meter.Report(); });
}

int MeasureDelay(const MeterArgs& args) {
  const std::stop_token stop = StopOnSignals();
  dds::Bus bus(SurveyOptionsFrom(args.topic.network));
  const inspector::OpenTopic topic = OpenTopicFrom(args.topic, bus, stop);
  inspector::DelayListener delay(bus, topic, args.window, args.machine_clock);
  return PrintReports(
      bus, args, topic.info.name, stop, [&] { return delay.received(); }, [&] { return delay.Report(); });
}

std::shared_ptr<MeterArgs> AddMeterArgs(CLI::App& command, std::size_t window) {
  const auto args = std::make_shared<MeterArgs>();
  args->window = window;
  AddTopicArgs(command, args->topic);
  command.add_option("--window", args->window, "Messages that a figure is computed from")
      ->check(CLI::Range(2, 10'000'000))
      ->capture_default_str();
  command.add_option("--seconds", args->seconds, "[s] End after this time")->check(NumberFrom(0.001, 1e9));
  return args;
}

}  // namespace

void AddTopicMeters(CLI::App& topic, int& exit_code) {
  CLI::App* const hz = topic.add_subcommand("hz", "Print the rate at which messages arrive");
  hz->callback([args = AddMeterArgs(*hz, 10'000), &exit_code] {
    exit_code = Measure<inspector::RateMeter>(
        *args,
        [](inspector::RateMeter& meter, const dds::RawSample& sample) { meter.Add(sample.reception_stamp); });
  });
  CLI::App* const bw = topic.add_subcommand("bw", "Print the bandwidth that messages take");
  bw->callback([args = AddMeterArgs(*bw, 100), &exit_code] {
    exit_code = Measure<inspector::BandwidthMeter>(
        *args, [](inspector::BandwidthMeter& meter, const dds::RawSample& sample) {
          meter.Add(sample.reception_stamp, sample.bytes.size());
        });
  });
  CLI::App* const delay =
      topic.add_subcommand("delay", "Print the time from a message's stamp to its arrival");
  const auto args = AddMeterArgs(*delay, 10'000);
  delay->add_flag("--machine-clock", args->machine_clock,
                  "Against this machine's clock, also where a run has its own");
  delay->callback([args, &exit_code] { exit_code = MeasureDelay(*args); });
}

}  // namespace thalweg::cli
