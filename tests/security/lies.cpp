#include "tests/security/lies.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "common/dds/convert.h"
#include "common/dds/schema.h"
#include "services/inspector/core/cdr.h"
#include "services/inspector/core/schema.h"
#include "services/inspector/core/value.h"

namespace thalweg::test {
namespace {

namespace topics = dds::topics;
using inspector::Arity;
using inspector::FieldType;
using inspector::Kind;
using inspector::Number;
using inspector::Value;
using std::chrono_literals::operator""s;

// ---- Messages of any type ----------------------------------------------------------------------------

/// How every field of a message is filled.
enum class Temper {
  kEmpty,      ///< Zeros, no text, no elements.
  kHuge,       ///< The largest numbers, three elements each.
  kLow,        ///< The smallest numbers, NaN.
  kEscapes,    ///< Terminal escapes in each text.
  kLong,       ///< 20 kB in each text.
  kPlausible,  ///< Frames, stamps, session and number of the run; else zeros.
};

class Filling {
 public:
  Filling(const inspector::Schema& schema, Temper temper, const Heard& heard)
      : schema_(schema), temper_(temper), heard_(heard) {}

  Value Of(const FieldType& type, const std::string& name) const {
    if (type.arity == Arity::kOne) return One(type, name);
    const std::size_t some = temper_ == Temper::kEmpty || temper_ == Temper::kPlausible ? 0 : 3;
    const std::size_t size = type.arity == Arity::kArray ? type.length : some;
    if (inspector::IsNumber(type.kind)) {
      inspector::Numbers numbers(type.kind);
      for (std::size_t k = 0; k < size; ++k) numbers.Append(NumberOf(type.kind, name));
      return {std::move(numbers)};
    }
    std::vector<Value> values;
    for (std::size_t k = 0; k < size; ++k) values.push_back(One(type.element(), name));
    return {std::move(values)};
  }

 private:
  Value One(const FieldType& type, const std::string& name) const {
    if (type.kind == Kind::kString) return {TextOf(name)};
    if (type.kind != Kind::kMessage) return {NumberOf(type.kind, name)};
    const inspector::MessageType& message = schema_.message(type);
    const bool is_stamp = message.name.ends_with("/Time");
    std::vector<Value> fields;
    for (const inspector::Field& field : message.fields) {
      Value& value = fields.emplace_back();
      if (is_stamp && temper_ == Temper::kPlausible) {
        value.content = StampPart(field);
      } else {
        value = Of(field.type, field.name);
      }
    }
    return {std::move(fields)};
  }

  Number StampPart(const inspector::Field& field) const {
    const builtin_interfaces::msg::Time now = dds::ToIdl(heard_.now);
    if (field.type.kind == Kind::kInt32) return static_cast<std::int64_t>(now.sec());
    return static_cast<std::uint64_t>(now.nanosec());
  }

  std::string TextOf(const std::string& name) const {
    switch (temper_) {
      case Temper::kEmpty:
        return "";
      case Temper::kLong:
        return std::string(20'000, 'x');
      case Temper::kPlausible:
        if (name == "frame_id") return dds::kMapFrame;
        return name == "child_frame_id" ? dds::kBodyFrame : "false";
      default:
        return TerminalEscapes();
    }
  }

  Number NumberOf(Kind kind, const std::string& name) const {
    Number number;
    inspector::WithTypeOf(kind, [&]<class T>(T) {
      const T value = OfType<T>(name);
      if constexpr (std::is_floating_point_v<T>) {
        number = value;
      } else if constexpr (std::is_signed_v<T>) {
        number = static_cast<std::int64_t>(value);
      } else {
        number = static_cast<std::uint64_t>(value);
      }
    });
    return number;
  }

  template <class T>
  T OfType(const std::string& name) const {
    using Limits = std::numeric_limits<T>;
    switch (temper_) {
      case Temper::kHuge:
      case Temper::kEscapes:
        return Limits::max();
      case Temper::kLow:
        return Limits::has_quiet_NaN ? Limits::quiet_NaN() : Limits::lowest();
      case Temper::kPlausible:
        if (name == "w" || name == "voxel_size_m") return T(1);
        if (name == "session") return static_cast<T>(heard_.session);
        if (name == "number") return static_cast<T>(heard_.number + 1);
        return T(0);
      default:
        return T(0);
    }
  }

  const inspector::Schema& schema_;
  Temper temper_;
  const Heard& heard_;
};

std::vector<Lie> LiesOfAnyType(const dds::TopicInfo& topic, const Heard& heard) {
  const std::string type = dds::Ros2TypeName(topic.type_name);
  const auto schema = inspector::Schema::Parse(type, dds::Ros2MsgSchema(type));
  if (!schema) throw std::runtime_error(topic.name + ": " + schema.error());
  const std::pair<Temper, const char*> tempers[] = {{Temper::kEmpty, "empty"},
                                                    {Temper::kHuge, "huge numbers"},
                                                    {Temper::kLow, "NaN and low numbers"},
                                                    {Temper::kEscapes, "escapes"},
                                                    {Temper::kLong, "long texts"},
                                                    {Temper::kPlausible, "plausible zeros"}};
  std::vector<Lie> lies;
  for (const auto& [temper, what] : tempers) {
    const Value value = Filling(*schema, temper, heard).Of(schema->root(), "");
    lies.push_back({what, inspector::EncodeCdr(*schema, value)});
  }
  return lies;
}

// ---- Messages that would do harm ---------------------------------------------------------------------

template <class Message>
using Harm = std::vector<std::pair<std::string, Message>>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

RigidTransform Shifted(const Heard& heard, double x, double y = 0.0) {
  RigidTransform T = heard.T_WB;
  T.translation() += Eigen::Vector3d(x, y, 0.0);
  return T;
}

geometry_msgs::msg::Point PointOf(const Eigen::Vector3d& p_W) {
  geometry_msgs::msg::Point point;
  point.x(p_W.x());
  point.y(p_W.y());
  point.z(p_W.z());
  return point;
}

/// Nothing is known of a type that has no function of its own below.
template <class Message>
void AddHarm(const Heard&, Harm<Message>&) {}

void AddHarm(const Heard& heard, Harm<rosgraph_msgs::msg::Clock>& harm) {
  const auto clock = [](Time time) {
    rosgraph_msgs::msg::Clock message;
    message.clock(dds::ToIdl(time));
    return message;
  };
  harm.emplace_back("runs ahead", clock(heard.now + 1000s));
  harm.emplace_back("runs back", clock(Time{} + 1s));
  harm.emplace_back("stands", clock(heard.now));
}

void AddHarm(const Heard& heard, Harm<nav_msgs::msg::Odometry>& harm) {
  const auto odometry = [](Time stamp, const RigidTransform& T_WB) {
    return dds::OdometryToIdl(stamp, T_WB, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  };
  harm.emplace_back("jumps by 0.5 m", odometry(heard.now, Shifted(heard, 0.5)));
  harm.emplace_back("jumps by 1000 m", odometry(heard.now, Shifted(heard, -1000.0)));
  harm.emplace_back("of the future", odometry(heard.now + 3600s, heard.T_WB));
  auto no_number = odometry(heard.now, heard.T_WB);
  no_number.pose().pose().position().x(kNan);
  harm.emplace_back("NaN", no_number);
}

void AddHarm(const Heard& heard, Harm<tf2_msgs::msg::TFMessage>& harm) {
  harm.emplace_back("jumps by 1 m",
                    dds::TransformsToIdl(heard.now, Shifted(heard, 1.0), RigidTransform::Identity()));
}

void AddHarm(const Heard& heard, Harm<nav_msgs::msg::Path>& harm) {
  const Time stamp = heard.now + 1s;
  const auto path = [&](std::vector<RigidTransform> T_WBs) {
    return dds::ToIdl(dds::StampedPath{stamp, std::move(T_WBs)});
  };
  harm.emplace_back("through a wall along x", path({heard.T_WB, Shifted(heard, 100.0)}));
  harm.emplace_back("through a wall along y", path({heard.T_WB, Shifted(heard, 0.0, -100.0)}));
  harm.emplace_back("begins elsewhere", path({Shifted(heard, 50.0), Shifted(heard, 51.0)}));
  harm.emplace_back("a stop", path({}));
  auto no_number = path({heard.T_WB, Shifted(heard, 0.3)});
  no_number.poses()[1].pose().position().y(kNan);
  harm.emplace_back("NaN", no_number);
  harm.emplace_back("9000 poses", path(std::vector<RigidTransform>(9000, heard.T_WB)));
}

void AddHarm(const Heard& heard, Harm<geometry_msgs::msg::PoseStamped>& harm) {
  harm.emplace_back("through a wall", dds::PoseStampedToIdl(heard.now, Shifted(heard, 100.0)));
  harm.emplace_back("without a stamp", dds::PoseStampedToIdl(Time{}, Shifted(heard, 0.0, -100.0)));
  auto no_number = dds::PoseStampedToIdl(heard.now, heard.T_WB);
  no_number.pose().orientation().w(kNan);
  harm.emplace_back("NaN", no_number);
}

void AddHarm(const Heard&, Harm<geometry_msgs::msg::Twist>& harm) {
  harm.emplace_back("10 m/s", dds::TwistToIdl({10.0, 0.0, 0.0}, {0.0, 0.0, 0.0}));
  harm.emplace_back("NaN", dds::TwistToIdl({kNan, kNan, kNan}, {kNan, 0.0, 0.0}));
}

void AddHarm(const Heard& heard, Harm<geometry_msgs::msg::TwistStamped>& harm) {
  harm.emplace_back("10 m/s",
                    dds::TwistStampedToIdl(heard.now, dds::TwistToIdl({10.0, 0.0, 0.0}, {0, 0, 0})));
}

void AddHarm(const Heard& heard, Harm<sensor_msgs::msg::PointCloud2>& harm) {
  constexpr int kSide = 64;
  const auto cloud = [&](float z) {
    std::vector<dds::ValuedPoint> points;
    for (int k = 0; k < kSide * kSide; ++k) {
      const auto u = static_cast<float>(k % kSide - kSide / 2) / kSide;
      const auto v = static_cast<float>(k / kSide - kSide / 2) / kSide;
      points.push_back({{u * z, v * z, z}, 0.0F});
    }
    auto message = dds::ToIdl(heard.now, points);
    message.header().frame_id(dds::kCameraFrame);
    return message;
  };
  harm.emplace_back("nothing but space", cloud(5.0F));
  harm.emplace_back("a wall before the lens", cloud(0.25F));
  auto false_size = cloud(1.0F);
  false_size.height(std::numeric_limits<std::uint32_t>::max());
  false_size.width(std::numeric_limits<std::uint32_t>::max());
  harm.emplace_back("2^64 points", false_size);
}

void AddHarm(const Heard& heard, Harm<sensor_msgs::msg::Image>& harm) {
  sensor_msgs::msg::Image image;
  image.header(dds::MakeHeader(heard.now, dds::kCameraFrame));
  image.height(1U << 31U);
  image.width(1U << 31U);
  image.step(8);
  image.encoding("32FC1");
  image.data(std::vector<std::uint8_t>(64));
  harm.emplace_back("2^62 pixels in 64 bytes", image);
}

thalweg_msgs::msg::MapUpdate EmptyUpdate(const Heard& heard) {
  thalweg_msgs::msg::MapUpdate update;
  update.header(dds::MakeHeader(heard.now, dds::kMapFrame));
  update.session(heard.session);
  update.number(heard.number + 1);
  update.full(false);
  update.voxel_size_m(heard.voxel_size);
  return update;
}

/// A block in which everything is free, or solid.
thalweg_msgs::msg::MapBlock Block(std::int32_t x, std::int32_t y, std::int32_t z, float log_odds) {
  thalweg_msgs::msg::MapBlock block;
  block.x(x);
  block.y(y);
  block.z(z);
  block.mask().fill(0xff);
  block.log_odds(std::vector<float>(512, log_odds));
  return block;
}

void AddHarm(const Heard& heard, Harm<thalweg_msgs::msg::MapUpdate>& harm) {
  for (const auto& [what, log_odds] : {std::pair{"all is free", -2.0F}, std::pair{"all is solid", 3.0F}}) {
    auto update = EmptyUpdate(heard);
    for (int k = 0; k < 343; ++k) {
      update.blocks().push_back(Block(k % 7 - 3, k / 7 % 7 - 3, k / 49 - 3, log_odds));
    }
    harm.emplace_back(what, update);
    update.session(heard.session + 1);
    update.number(1);
    update.full(true);
    harm.emplace_back(std::string("another session, ") + what, update);
  }
  auto update = EmptyUpdate(heard);
  update.number(std::numeric_limits<std::uint64_t>::max());
  harm.emplace_back("number 2^64 - 1", update);
  update = EmptyUpdate(heard);
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  update.blocks({Block(kMost, -kMost - 1, kMost, 1.0F)});
  harm.emplace_back("a block at 2^31 - 1", update);
  update = EmptyUpdate(heard);
  update.full(true);
  for (int k = 0; k < 200; ++k) update.blocks().push_back(Block(1000 * k, -1000 * k, 900 * k, -2.0F));
  harm.emplace_back("a map 100 km wide", update);
  update = EmptyUpdate(heard);
  update.full(true);
  update.voxel_size_m(1e-4);
  harm.emplace_back("other voxels", update);
}

void AddHarm(const Heard& heard, Harm<thalweg_msgs::msg::MapRequest>& harm) {
  thalweg_msgs::msg::MapRequest request;
  request.header(dds::MakeHeader(heard.now, dds::kMapFrame));
  request.reader(TerminalEscapes());
  harm.emplace_back("a request", request);
}

void AddHarm(const Heard& heard, Harm<thalweg_msgs::msg::ExplorationStatus>& harm) {
  thalweg_msgs::msg::ExplorationStatus status;
  status.header(dds::MakeHeader(heard.now, dds::kMapFrame));
  status.strategy("closest");
  status.state(thalweg_msgs::msg::EXPLORATION_DONE);
  status.outcome(thalweg_msgs::msg::OUTCOME_COMPLETE);
  status.stop_reason("complete");
  harm.emplace_back("complete", status);
  status.state(thalweg_msgs::msg::EXPLORATION_PAUSED);
  harm.emplace_back("paused", status);
}

void AddHarm(const Heard& heard, Harm<thalweg_msgs::msg::OperatorCommand>& harm) {
  constexpr std::pair<thalweg_msgs::msg::CommandKind, const char*> kKinds[] = {
      {thalweg_msgs::msg::COMMAND_GOTO, "go into a wall"},
      {thalweg_msgs::msg::COMMAND_LOOK_AT, "look"},
      {thalweg_msgs::msg::COMMAND_IGNORE_FRONTIER, "ignore a frontier"},
      {thalweg_msgs::msg::COMMAND_STRATEGY, "another strategy"},
      {thalweg_msgs::msg::COMMAND_SAVE_MAP, "save the map"},
      {thalweg_msgs::msg::COMMAND_NO_GO_BOX, "keep out of everything"},
      {thalweg_msgs::msg::COMMAND_HOME, "go home"},
      {thalweg_msgs::msg::COMMAND_STOP, "stop"}};
  std::uint64_t id = static_cast<std::uint64_t>(heard.now.time_since_epoch().count());
  for (const auto& [kind, what] : kKinds) {
    thalweg_msgs::msg::OperatorCommand command;
    command.header(dds::MakeHeader(heard.now, dds::kMapFrame));
    command.sender("attacker" + TerminalEscapes());
    command.id(++id);
    command.kind(kind);
    const Eigen::Vector3d p_W = heard.T_WB.translation();
    const bool is_box = kind == thalweg_msgs::msg::COMMAND_NO_GO_BOX;
    command.point(PointOf(p_W + Eigen::Vector3d::Constant(is_box ? -100.0 : 2.0)));
    command.corner(PointOf(p_W + Eigen::Vector3d::Constant(100.0)));
    command.yaw_rad(kNan);
    command.strategy(TerminalEscapes());
    harm.emplace_back(what, command);
  }
}

void AddHarm(const Heard& heard, Harm<thalweg_msgs::msg::CommandReply>& harm) {
  thalweg_msgs::msg::CommandReply reply;
  reply.header(dds::MakeHeader(heard.now, dds::kMapFrame));
  reply.service("explorer");
  reply.sender("operator");
  reply.accepted(true);
  reply.reason(TerminalEscapes());
  harm.emplace_back("accepted", reply);
}

void AddHarm(const Heard& heard, Harm<thalweg_msgs::msg::MotionStatus>& harm) {
  thalweg_msgs::msg::MotionStatus status;
  status.header(dds::MakeHeader(heard.now, dds::kMapFrame));
  status.path_stamp(dds::ToIdl(heard.now));
  for (const auto state : {thalweg_msgs::msg::MOTION_DONE, thalweg_msgs::msg::MOTION_STOPPED}) {
    status.state(state);
    status.reason(TerminalEscapes());
    harm.emplace_back(state == thalweg_msgs::msg::MOTION_DONE ? "done" : "stopped", status);
  }
}

void AddHarm(const Heard& heard, Harm<thalweg_msgs::msg::OdometryStatus>& harm) {
  thalweg_msgs::msg::OdometryStatus status;
  status.header(dds::MakeHeader(heard.now, dds::kOdometryFrame));
  status.state(thalweg_msgs::msg::ODOMETRY_LOST);
  status.reason(TerminalEscapes());
  harm.emplace_back("lost", status);
}

void AddHarm(const Heard& heard, Harm<thalweg_msgs::msg::SimulationStatus>& harm) {
  thalweg_msgs::msg::SimulationStatus status;
  status.header(dds::MakeHeader(heard.now, dds::kMapFrame));
  status.map_from_body_true(dds::ToIdl(Shifted(heard, 3.0)));
  status.true_collisions(99);
  harm.emplace_back("99 collisions", status);
}

void AddHarm(const Heard& heard, Harm<thalweg_msgs::msg::ServiceHealth>& harm) {
  for (const char* service : {"mapper", "explorer", "controller", "simulator", "thalweg"}) {
    thalweg_msgs::msg::ServiceHealth health;
    health.header(dds::MakeHeader(heard.now, ""));
    health.service(service);
    health.host(TerminalEscapes());
    health.instance(1);
    health.uptime_s(1e6);
    thalweg_msgs::msg::Counter counter;
    counter.name("files");
    counter.count(std::numeric_limits<std::uint64_t>::max());
    counter.last(TerminalEscapes());
    health.rejected({counter});
    health.dropped({counter});
    harm.emplace_back(std::string("an older ") + service, health);
  }
}

template <class Topic>
void AddLies(const dds::TopicInfo& topic, const Heard& heard, std::vector<Lie>& lies) {
  if (topic.name != Topic::kName) return;
  Harm<dds::MessageOf<Topic>> harm;
  AddHarm(heard, harm);
  for (const auto& [what, message] : harm) lies.push_back({what, dds::Encode<Topic>(message)});
}

template <class... Topics>
void AddLiesOf(const std::tuple<Topics...>*, const dds::TopicInfo& topic, const Heard& heard,
               std::vector<Lie>& lies) {
  (AddLies<Topics>(topic, heard, lies), ...);
}

}  // namespace

void Heard::Note(const dds::TopicInfo& topic, std::span<const std::uint8_t> sample) {
  if (topic.name == topics::Clock::kName) {
    const auto message = dds::Decode<topics::Clock>(sample);
    const auto time = message ? dds::FromIdl(message->clock()) : Error{"no clock"};
    if (time) now = *time;
  } else if (topic.name == topics::Odometry::kName) {
    const auto message = dds::Decode<topics::Odometry>(sample);
    const auto pose = message ? dds::FromIdl(*message) : Error{"no pose"};
    if (pose) T_WB = pose->T;
  } else if (topic.name == topics::MapUpdates::kName) {
    const auto message = dds::Decode<topics::MapUpdates>(sample);
    if (!message) return;
    session = message->session();
    number = message->number();
    voxel_size = message->voxel_size_m();
  }
}

std::string TerminalEscapes() {
  return "\x1b]0;owned\x07\x1b[2J\x1b[31mowned\x1b[0m\r\n\xe2\x80\xae\xff<b>";
}

std::vector<Lie> LiesFor(const dds::TopicInfo& topic, const Heard& heard) {
  std::vector<Lie> lies = LiesOfAnyType(topic, heard);
  AddLiesOf(static_cast<const topics::All*>(nullptr), topic, heard, lies);
  return lies;
}

}  // namespace thalweg::test
