#include "services/gateway/core/command.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/text.h"
#include "services/gateway/core/json_text.h"

namespace thalweg::gateway {
namespace {

using nlohmann::json;

constexpr std::array<CommandService, 16> kServices = {{
    {"pause", CommandKind::kPause, "Stop wherever the robot is, and wait"},
    {"resume", CommandKind::kResume, "Continue exploring"},
    {"step", CommandKind::kStep, "Make one decision, carry it out and pause"},
    {"stop", CommandKind::kStop, "End the exploration here"},
    {"home", CommandKind::kHome, "Go to where the robot set out, and end there"},
    {"goto", CommandKind::kGoTo, "Go to a point in known free space and pause", true, false, true},
    {"look_at", CommandKind::kLookAt, "Look at a point and pause", true},
    {"ignore", CommandKind::kIgnoreFrontier, "Never go for the frontier nearest to a point", true},
    {"no_go", CommandKind::kNoGoBox, "Keep out of the box from point to corner", true, true},
    {"clear_no_go", CommandKind::kClearNoGo, "Remove all boxes that commands have drawn"},
    {"strategy", CommandKind::kStrategy, "Choose by another strategy", false, false, false, true},
    {"save_map", CommandKind::kSaveMap, "Write the map's files now"},
    {"pause", CommandKind::kReplayPause, "Pause the replay"},
    {"resume", CommandKind::kReplayResume, "Go on with the replay"},
    {.name = "seek",
     .kind = CommandKind::kReplaySeek,
     .help = "Replay from another time on: time_s [s] after the recording's beginning, or its log time",
     .time = true},
    {.name = "rate",
     .kind = CommandKind::kReplayRate,
     .help = "Replay so many seconds of the recording per second",
     .rate = true},
}};

std::optional<double> Number(const json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

Result<std::array<double, 3>> PointIn(const json& object, const char* name) {
  const auto found = object.find(name);
  if (found != object.end() && found->is_object()) {
    const auto x = Number(*found, "x");
    const auto y = Number(*found, "y");
    const auto z = Number(*found, "z");
    if (x && y && z) return std::array<double, 3>{*x, *y, *z};
  }
  return Error{std::string("\"") + name + "\" must be an object with the numbers x, y and z [m]"};
}

/// "time_s": 12.5, or "time": {"sec": 1700000000, "nanosec": 0} as in the message.
Result<std::variant<Duration, Time>> TimeIn(const json& object) {
  using Either = std::variant<Duration, Time>;
  constexpr double kLongest = 1e9;  // [s] which a Duration can hold
  const auto seconds = Number(object, "time_s");
  if (seconds && std::abs(*seconds) <= kLongest) return Either(FromSeconds(*seconds));
  const auto time = object.find("time");
  if (!object.contains("time_s") && time != object.end() && time->is_object()) {
    const auto sec = Number(*time, "sec");
    const auto nanosec = Number(*time, "nanosec");
    if (sec && nanosec && *sec >= 0.0 && *sec <= 4.0 * kLongest && *nanosec >= 0.0 && *nanosec < 1e9) {
      return Either(Time(std::chrono::seconds(static_cast<std::int64_t>(*sec)) +
                         Duration(static_cast<std::int64_t>(*nanosec))));
    }
  }
  return Error{
      "the request must have \"time_s\", a number of seconds since the recording's beginning, or \"time\", "
      "an "
      "object with the numbers sec and nanosec"};
}

Result<Command> Read(const CommandService& service, const json& object) {
  Command command;
  command.kind = service.kind;
  for (const auto& [wanted, name, to] : {std::tuple(service.point, "point", &command.point),
                                         std::tuple(service.corner, "corner", &command.corner)}) {
    if (!wanted) continue;
    const auto point = PointIn(object, name);
    if (!point) return Error{point.error()};
    *to = *point;
  }
  if (service.yaw && object.contains("yaw_rad") && !object["yaw_rad"].is_null()) {
    const auto yaw = Number(object, "yaw_rad");
    if (!yaw) return Error{"\"yaw_rad\" must be a number, or absent for any heading"};
    command.yaw_rad = *yaw;
  }
  if (service.strategy) {
    const auto name = object.find("strategy");
    if (name == object.end() || !name->is_string() || name->get<std::string>().size() > kLongestName)
      return Error{"\"strategy\" must be a text of at most 64 characters"};
    command.strategy = name->get<std::string>();
  }
  if (service.time) {
    const auto time = TimeIn(object);
    if (!time) return Error{time.error()};
    command.time = *time;
  }
  if (service.rate) {
    const auto rate = Number(object, "rate");
    if (!rate) return Error{"\"rate\" must be a number"};
    command.rate = *rate;
  }
  return command;
}

const CommandService* ServiceOf(CommandGroup group, const json& kind) {
  const auto found = std::ranges::find_if(kServices, [&](const CommandService& service) {
    if (service.group() != group) return false;
    if (kind.is_string()) return kind.get<std::string>() == service.name;
    return kind.is_number_unsigned() && kind.get<std::uint64_t>() == service.number();
  });
  return found == kServices.end() ? nullptr : &*found;
}

}  // namespace

std::span<const CommandService> CommandServices() {
  return kServices;
}

std::string NameOf(const CommandService& service) {
  return (service.group() == CommandGroup::kOperator ? "/operator/" : "/replay/") + std::string(service.name);
}

Result<Command> ParseRequest(const CommandService& service, std::string_view text) {
  const std::optional<json> object = text.empty() ? json::object() : ParseObject(text);
  if (!object) return Error{"the request is not a JSON object"};
  return Read(service, *object);
}

Result<Command> ParseStrategy(std::string_view text) {
  const auto service = std::ranges::find(kServices, CommandKind::kStrategy, &CommandService::kind);
  return Read(*service, {{"strategy", json::parse(text, nullptr, false)}});
}

Result<Command> ParseCommand(CommandGroup group, std::string_view text) {
  const std::optional<json> object = ParseObject(text);
  if (!object) return Error{"the command is not a JSON object"};
  const CommandService* const service =
      object->contains("kind") ? ServiceOf(group, (*object)["kind"]) : nullptr;
  if (service == nullptr)
    return Error{"\"kind\" must be the name of a command, such as \"pause\", or its number"};
  return Read(*service, *object);
}

std::string RequestSchema(const CommandService& service) {
  const json number = {{"type", "number"}};
  const json point = {{"type", "object"},
                      {"properties", {{"x", number}, {"y", number}, {"z", number}}},
                      {"required", {"x", "y", "z"}}};
  json properties = json::object();
  json required = json::array();
  const auto add = [&](bool wanted, const char* name, const json& type) {
    if (!wanted) return;
    properties[name] = type;
    required.push_back(name);
  };
  add(service.point, "point", point);
  add(service.corner, "corner", point);
  add(service.strategy, "strategy", {{"type", "string"}});
  add(service.rate, "rate", number);
  if (service.yaw) properties["yaw_rad"] = number;
  if (service.time) {  // either of them
    properties["time_s"] = number;
    properties["time"] = {{"type", "object"}, {"properties", {{"sec", number}, {"nanosec", number}}}};
  }
  return json{
      {"type", "object"}, {"description", service.help}, {"properties", properties}, {"required", required}}
      .dump();
}

std::string ReplySchema() {
  const json text = {{"type", "string"}};
  return json{{"type", "object"},
              {"properties", {{"accepted", {{"type", "boolean"}}}, {"service", text}, {"reason", text}}}}
      .dump();
}

std::string ToJson(const CommandAnswer& answer) {
  return Dump({{"accepted", answer.accepted}, {"service", answer.service}, {"reason", answer.reason}});
}

}  // namespace thalweg::gateway
