#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <stop_token>
#include <thread>

#include "common/compression/compression.h"
#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/inspector/adapter/message_definitions.h"
#include "services/inspector/core/cdr.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/adapter/player.h"
#include "services/recorder/core/mcap_reader.h"
#include "services/recorder/core/mcap_writer.h"

namespace {

using namespace thalweg;
using namespace thalweg::recorder;

constexpr int kMessages = 300;

template <class Topic>
Channel ChannelOf() {
  const dds::TopicInfo topic = dds::InfoOf<Topic>();
  const std::string type = dds::Ros2TypeName(topic.type_name);
  return {.topic = "/" + topic.name,
          .type = type,
          .schema = std::string(dds::Ros2MsgSchema(type)),
          .metadata = {}};
}

/// Messages whose contents follow from their number, which check.js computes as well.
void Write(const std::string& file, Compression compression) {
  std::ofstream out(file, std::ios::binary);
  McapWriter writer({.compression = compression, .chunk_bytes = 10'000}, [&](Bytes bytes) {
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  });
  writer.AddMetadata({"scenario", {{"name", "kitchen"}}});
  const std::uint16_t odometry = writer.AddChannel(ChannelOf<dds::topics::Odometry>());
  const std::uint16_t status = writer.AddChannel(ChannelOf<dds::topics::ExplorationStatus>());
  for (int k = 0; k < kMessages; ++k) {
    const Time time{std::chrono::seconds(1'700'000'000) + std::chrono::milliseconds(10 * k)};
    const auto sequence = static_cast<std::uint32_t>(k / 2);
    if (k % 2 == 0) {
      const auto message =
          dds::OdometryToIdl(time, MakeTransform(RotationFromYawPitch(0.0, 0.0), {0.5 * k, -1.0, 2.0}),
                             {0.25 * k, 0.0, 0.0}, {0.0, 0.0, 0.0});
      writer.Write(odometry, sequence, time, time, dds::Encode<dds::topics::Odometry>(message));
    } else {
      thalweg_msgs::msg::ExplorationStatus message;
      message.header(dds::MakeHeader(time, dds::kMapFrame));
      message.strategy("flow");
      message.state(thalweg_msgs::msg::EXPLORATION_MOVING);
      message.plans(static_cast<std::uint32_t>(k));
      message.distance_m(0.125 * k);
      thalweg_msgs::msg::SetAside aside;
      aside.reason(thalweg_msgs::msg::ASIDE_TOO_SMALL);
      aside.voxels(static_cast<std::uint32_t>(k));
      message.set_aside({aside, aside});
      writer.Write(status, sequence, time, time, dds::Encode<dds::topics::ExplorationStatus>(message));
    }
  }
  writer.Close();
}

/// One line of JSON for each message, and one at the end.
void Print(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const auto reader = McapReader::Open(bytes);
  if (!reader) throw std::runtime_error(file + ": " + reader.error());
  MessageCursor cursor = reader->Read();
  while (const auto message = cursor.Next()) {
    const Channel& channel = reader->channels().at(message->channel);
    std::cout << nlohmann::json{{"topic", channel.topic},
                                {"type", channel.type},
                                {"sequence", message->sequence},
                                {"log", std::to_string(message->log_time.time_since_epoch().count())},
                                {"publish", std::to_string(message->publish_time.time_since_epoch().count())},
                                {"size", message->payload.size()},
                                {"crc", Crc32(message->payload)}}
              << '\n';
  }
  Problems problems = reader->Check();
  problems.Add(cursor.problems());
  std::cout << nlohmann::json{{"summary", reader->has_summary()}, {"problems", problems.texts()}} << '\n';
}

/// Plays the map requests of a recording onto a bus, and prints, as one line of JSON each, those that a
/// reader of it decodes.
void Play(const std::string& name) {
  using Topic = dds::topics::MapRequests;
  const MappedFile file(name);
  const auto reader = McapReader::Open(file.bytes());
  if (!reader) throw std::runtime_error(name + ": " + reader.error());
  dds::BusOptions options;
  options.name = "recording_example";
  options.domain = 1 + getpid() % 99;
  options.partition = "recording_example." + std::to_string(getpid());
  options.publish_health = false;
  dds::Bus playing(options);
  dds::Bus listening(options);
  std::size_t heard = 0;
  listening.Subscribe<Topic>([&](const auto& message) {
    std::cout << nlohmann::json{{"frame", message.header().frame_id()},
                                {"reader", message.reader()},
                                {"number", message.number()},
                                {"reason", message.reason()}}
              << '\n';
    ++heard;
  });
  Player player(*reader, {.topics = {Topic::kName}}, playing);
  constexpr auto kPatience = std::chrono::seconds(20);
  if (!player.AwaitReaders(kPatience) ||
      !listening.SpinUntil([&] { return listening.Writers<Topic>() > 0; }, kPatience)) {
    throw std::runtime_error("player and listener do not find each other");
  }
  const std::jthread thread([&](const std::stop_token& stop) { player.Run(stop); });
  listening.SpinUntil([&] { return heard == reader->message_count(); }, kPatience);
}

void PrintSchemas() {
  nlohmann::json schemas;
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    const std::string type = dds::Ros2TypeName(topic.type_name);
    schemas[type] = dds::Ros2MsgSchema(type);
  }
  std::cout << schemas << '\n';
}

inspector::Schema SchemaOf(const std::string& type) {
  const auto text = inspector::MessageDefinition(type, {});
  if (!text) throw std::runtime_error(text.error());
  const auto schema = inspector::Schema::Parse(type, *text);
  if (!schema) throw std::runtime_error(schema.error());
  return *schema;
}

/// Definitions of the types that are named on standard input, one a line.
void PrintDefinitions() {
  nlohmann::json definitions;
  for (std::string type; std::getline(std::cin, type);) {
    const auto text = inspector::MessageDefinition(type, {});
    definitions[type] = text ? *text : "";
  }
  std::cout << definitions << '\n';
}

/// Decodes and encodes messages: of {"type": [octets]} on standard input makes the same again.
void Recode() {
  nlohmann::json messages = nlohmann::json::parse(std::cin);
  for (auto& [type, octets] : messages.items()) {
    const inspector::Schema schema = SchemaOf(type);
    const auto value = inspector::DecodeCdr(schema, octets.get<std::vector<std::uint8_t>>());
    if (!value) throw std::runtime_error(type + ": " + value.error());
    octets = inspector::EncodeCdr(schema, *value);
  }
  std::cout << messages << '\n';
}

}  // namespace

/// For tests/tools/recorder/check.js.
/// usage: recording_example write FILE none|lz4|zstd; recording_example print FILE; recording_example play
/// FILE; recording_example schemas; recording_example definitions; recording_example recode
int main(int argc, char** argv) try {
  spdlog::set_default_logger(spdlog::stderr_color_mt("recording_example"));  // check.js reads what is printed
  const std::vector<std::string> args(argv + 1, argv + argc);
  if (args.size() == 3 && args[0] == "write") {
    Write(args[1], args[2] == "zstd"  ? Compression::kZstd
                   : args[2] == "lz4" ? Compression::kLz4
                                      : Compression::kNone);
  } else if (args.size() == 2 && args[0] == "print") {
    Print(args[1]);
  } else if (args.size() == 2 && args[0] == "play") {
    Play(args[1]);
  } else if (args.size() == 1 && args[0] == "schemas") {
    PrintSchemas();
  } else if (args.size() == 1 && args[0] == "definitions") {
    PrintDefinitions();
  } else if (args.size() == 1 && args[0] == "recode") {
    Recode();
  } else {
    throw std::runtime_error(
        "write FILE none|lz4|zstd, print FILE, play FILE, schemas, definitions or recode");
  }
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "recording_example: " << error.what() << '\n';
  return EXIT_FAILURE;
}
