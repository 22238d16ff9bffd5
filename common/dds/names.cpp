#include "common/dds/names.h"

#include <array>
#include <stdexcept>
#include <utility>

#include "common/dds/topic_table.h"

namespace thalweg::dds {
namespace {

/// Our frames, each with its name on the wire but for the robot's.
std::array<std::pair<const char*, const std::string*>, 4> PairsOf(const FrameNames& frames) {
  return {{{kMapFrame, &frames.map},
           {kOdometryFrame, &frames.odometry},
           {kBodyFrame, &frames.body},
           {kCameraFrame, &frames.camera}}};
}

std::string After(const std::string& robot, std::string_view name) {
  return robot.empty() ? std::string(name) : robot + '/' + std::string(name);
}

/// @param taken  What each name that is taken is the name of.
void Take(std::map<std::string, std::string>& taken, const char* kind, const std::string& name,
          const std::string& own) {
  const auto [other, is_new] = taken.emplace(name, own);
  if (is_new) return;
  throw std::runtime_error(std::string(kind) + " " + other->second + " and " + own +
                           " would both be called \"" + name + "\"");
}

}  // namespace

std::string Names::Topic(std::string_view name) const {
  const auto renamed = topics.find(name);
  const std::string_view known = renamed == topics.end() ? name : std::string_view(renamed->second);
  return known.starts_with('/') ? std::string(known.substr(1)) : After(robot, known);
}

std::string Names::Frame(std::string_view frame) const {
  for (const auto& [own, name] : PairsOf(frames)) {
    if (frame == own) return After(robot, *name);
  }
  return std::string(frame);
}

std::optional<std::string> Names::OwnFrame(std::string_view frame) const {
  for (const auto& [own, name] : PairsOf(frames)) {
    if (frame == After(robot, *name)) return own;
  }
  return std::nullopt;
}

std::string Names::FrameList() const {
  std::string list;
  for (const auto& [own, name] : PairsOf(frames)) {
    list += (list.empty() ? "\"" : ", \"") + After(robot, *name) + '"';
  }
  return list;
}

void Names::Check() const {
  std::map<std::string, std::string> taken;
  for (const TopicInfo& topic : AllTopics()) Take(taken, "topics", Topic(topic.name), topic.name);
  taken.clear();
  for (const auto& [own, name] : PairsOf(frames)) Take(taken, "frames", *name, own);
}

}  // namespace thalweg::dds
