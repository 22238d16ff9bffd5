#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/dds/topics.h"

namespace thalweg::dds {

/// Other names of topics, by those of topics.h.
using TopicNames = std::map<std::string, std::string, std::less<>>;

/// What the frames are called on the wire, without the robot's name.
struct FrameNames {
  std::string map = kMapFrame;
  std::string odometry = kOdometryFrame;
  std::string body = kBodyFrame;
  std::string camera = kCameraFrame;

  friend bool operator==(const FrameNames&, const FrameNames&) = default;
};

/// What the topics and frames of topics.h are called on the wire. Services know only those names; a Bus
/// translates.
struct Names {
  std::string robot;  ///< Before every name, followed by a slash; empty = nothing.
  TopicNames topics;
  FrameNames frames;

  /// The name of a topic without the leading rt/. As in ROS 2, one that begins with a slash stays as it is.
  std::string Topic(std::string_view name) const;
  /// The name of a frame; one that is none of ours stays as it is.
  std::string Frame(std::string_view frame) const;
  /// The inverse; nothing if no frame of ours is called that.
  std::optional<std::string> OwnFrame(std::string_view frame) const;
  /// The names of our frames, for people.
  std::string FrameList() const;

  bool renames_topics() const { return !robot.empty() || !topics.empty(); }
  bool renames_frames() const { return !robot.empty() || frames != FrameNames{}; }

  /// Throws std::runtime_error if two topics or two frames have the same name.
  void Check() const;
};

/// Calls `use` with each name of a frame in a message.
template <class Message, class Use>
void ForEachFrame(Message& message, const Use& use) {
  const auto each_of = [&](auto& parts) {
    for (auto& part : parts) ForEachFrame(part, use);
  };
  if constexpr (requires { message.header().frame_id(); }) use(message.header().frame_id());
  if constexpr (requires { message.child_frame_id(); }) use(message.child_frame_id());
  if constexpr (requires { message.transforms(); }) each_of(message.transforms());
  if constexpr (requires { message.poses(); }) each_of(message.poses());
  if constexpr (requires { message.markers(); }) each_of(message.markers());
  if constexpr (requires { message.image().header(); }) ForEachFrame(message.image(), use);
}

/// Gives the frames of a message the names that they have on the wire.
template <class Message>
void ToWireFrames(const Names& names, Message& message) {
  ForEachFrame(message, [&](std::string& frame) { frame = names.Frame(frame); });
}

/// Gives the frames of a message from the wire the names of topics.h. Transforms may be between frames of
/// others, which keep their names.
/// @return What is wrong with the message: a frame that is none of ours. An empty one is left to the reader.
template <class Message>
std::optional<std::string> ToOwnFrames(const Names& names, Message& message) {
  constexpr bool kForeignAllowed = requires {
    message.transforms();
  };
  std::optional<std::string> problem;
  ForEachFrame(message, [&](std::string& frame) {
    if (const auto own = names.OwnFrame(frame)) {
      frame = *own;
    } else if (!frame.empty() && !kForeignAllowed) {
      problem = "frame_id is \"" + frame + "\", must be one of the scenario's frames, " + names.FrameList();
    }
  });
  return problem;
}

}  // namespace thalweg::dds
