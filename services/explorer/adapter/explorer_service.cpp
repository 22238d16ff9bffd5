#include "services/explorer/adapter/explorer_service.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <utility>

#include "common/base/text.h"
#include "common/dds/convert.h"
#include "common/files/write_file.h"
#include "services/explorer/adapter/commands.h"
#include "services/explorer/adapter/convert.h"
#include "services/explorer/adapter/markers.h"
#include "services/explorer/adapter/text.h"
#include "services/explorer/text/outcome_text.h"

namespace thalweg::explorer {
namespace {

using dds::FromIdl;
using dds::ToIdl;

constexpr auto kHeartbeat = std::chrono::milliseconds(100);  // well within the path's lifespan
constexpr double kSavePeriodMs = 5000.0;
constexpr auto kStatusPeriod = std::chrono::milliseconds(500);

thalweg_msgs::msg::ExplorationState ToIdl(LoopState state) {
  switch (state) {
    case LoopState::kWaiting:
      return thalweg_msgs::msg::EXPLORATION_WAITING;
    case LoopState::kLooking:
      return thalweg_msgs::msg::EXPLORATION_LOOKING;
    case LoopState::kPlanning:
      return thalweg_msgs::msg::EXPLORATION_PLANNING;
    case LoopState::kMoving:
      return thalweg_msgs::msg::EXPLORATION_MOVING;
    case LoopState::kPaused:
      return thalweg_msgs::msg::EXPLORATION_PAUSED;
    case LoopState::kDone:
      break;
  }
  return thalweg_msgs::msg::EXPLORATION_DONE;
}

thalweg_msgs::msg::PlanInterruption ToIdl(Interruption interruption) {
  switch (interruption) {
    case Interruption::kPathBlocked:
      return thalweg_msgs::msg::INTERRUPTION_PATH_BLOCKED;
    case Interruption::kNotFacingPassage:
      return thalweg_msgs::msg::INTERRUPTION_NOT_FACING_PASSAGE;
    case Interruption::kTimeForHome:
      return thalweg_msgs::msg::INTERRUPTION_TIME_FOR_HOME;
    case Interruption::kDistanceForHome:
      return thalweg_msgs::msg::INTERRUPTION_DISTANCE_FOR_HOME;
    case Interruption::kTargetSeen:
      return thalweg_msgs::msg::INTERRUPTION_TARGET_SEEN;
    case Interruption::kClockReset:
      return thalweg_msgs::msg::INTERRUPTION_CLOCK_RESET;
    case Interruption::kLost:
      return thalweg_msgs::msg::INTERRUPTION_LOST;
    case Interruption::kControllerStopped:
      return thalweg_msgs::msg::INTERRUPTION_CONTROLLER_STOPPED;
    case Interruption::kMapReplaced:
      return thalweg_msgs::msg::INTERRUPTION_MAP_REPLACED;
    case Interruption::kMapSilent:
      return thalweg_msgs::msg::INTERRUPTION_MAP_SILENT;
    case Interruption::kOperator:
      break;
  }
  return thalweg_msgs::msg::INTERRUPTION_OPERATOR;
}

geometry_msgs::msg::Point ToPoint(const std::optional<Eigen::Vector3d>& p_W) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d p = p_W.value_or(Eigen::Vector3d::Constant(kNone));
  geometry_msgs::msg::Point point;
  point.x(p.x());
  point.y(p.y());
  point.z(p.z());
  return point;
}

thalweg_msgs::msg::Frontier ToIdl(const FrontierReport& report) {
  thalweg_msgs::msg::Frontier frontier;
  frontier.center(ToPoint(report.center_W));
  frontier.voxels(static_cast<std::uint32_t>(report.voxels));
  frontier.path_length_m(report.length);
  frontier.score(report.score);
  frontier.fate(report.fate == FrontierReport::Fate::kLeft     ? thalweg_msgs::msg::FRONTIER_LEFT
                : report.fate == FrontierReport::Fate::kChosen ? thalweg_msgs::msg::FRONTIER_CHOSEN
                                                               : thalweg_msgs::msg::FRONTIER_SET_ASIDE);
  frontier.reason(ToIdl(report.reason));
  frontier.doubtful(report.doubtful);
  return frontier;
}

std::vector<dds::ValuedPoint> PointsOf(const DenseGrid<float>& field, const PlanningMap& map) {
  std::vector<dds::ValuedPoint> points;
  for (std::size_t k = 0; k < field.size(); ++k) {
    if (std::isnan(field[k])) continue;
    points.push_back({map.CenterOf(field.IndexAt(k)).cast<float>(), field[k]});
  }
  return points;
}

std::vector<dds::ColoredPoint> PointsOf(const std::vector<VoxelIndex>& sealed, const PlanningMap& map) {
  constexpr Rgb kGreen{46, 160, 67};
  std::vector<dds::ColoredPoint> points;
  points.reserve(sealed.size());
  for (const VoxelIndex& voxel : sealed) points.push_back({map.CenterOf(voxel).cast<float>(), kGreen});
  return points;
}

/// Warns when the camera is outside the body, because planning keeps only the body clear of obstacles.
void WarnOfACameraOutside(const RobotModel& robot) {
  const Eigen::Vector3d& at_B = robot.T_BC.translation();
  const bool inside = robot.height > 0.0
                          ? at_B.head<2>().norm() <= robot.radius && std::abs(at_B.z()) <= 0.5 * robot.height
                          : at_B.norm() <= robot.radius;
  if (inside) return;
  spdlog::warn(
      "robot.camera_position_m lies outside the body given by radius_m{}: planning does not keep the camera "
      "clear of obstacles",
      robot.height > 0.0 ? " and height_m" : "");
}

}  // namespace

ExplorerService::ExplorerService(const Explorer::Options& options, dds::Bus& bus, ExplorationFile file,
                                 ViewSource views)
    : bus_(bus),
      sensor_range_(options.sensor_range),
      T_BC_(options.robot.T_BC),
      path_out_(bus.Advertise<dds::topics::Path>()),
      status_out_(bus.Advertise<dds::topics::ExplorationStatus>()),
      request_out_(bus.Advertise<dds::topics::MapRequests>()),
      frontiers_out_(bus.Advertise<dds::topics::Frontiers>()),
      markers_out_(bus.Advertise<dds::topics::FrontierMarkers>()),
      field_out_(bus.Advertise<dds::topics::Field>()),
      sealed_out_(bus.Advertise<dds::topics::Sealed>()),
      streamline_out_(bus.Advertise<dds::topics::Streamline>()),
      replies_out_(bus.Advertise<dds::topics::CommandReplies>()),
      loop_(options),
      file_(std::move(file)) {
  WarnOfACameraOutside(options.robot);
  if (loop_.explorer().AwaitsView()) {
    // What is beyond the range is no surface.
    views_.emplace(bus, dds::Infinity::kNoMeasurement, PoseContinuity::Options::For(options.robot));
    if (views == ViewSource::kDepthImages) {
      bus.Subscribe<dds::topics::DepthImage>([this](const auto& message) { OnDepth(message); });
      bus.Subscribe<dds::topics::DepthCameraInfo>([this](const auto& message) { OnDepth(message); });
    } else {
      bus.Subscribe<dds::topics::DepthPoints>([this](const auto& message) { OnDepth(message); });
    }
  }
  Continue();
  status_ = MakeStatus();
  bus.Subscribe<dds::topics::MapUpdates>([this](const auto& message) { OnMapUpdate(message); });
  bus.Subscribe<dds::topics::Odometry>([this](const auto& message) { OnOdometry(message); });
  bus.Subscribe<dds::topics::OdometryStatus>([this](const auto& message) { OnOdometryStatus(message); });
  bus.Subscribe<dds::topics::MotionStatus>([this](const auto& message) { OnMotionStatus(message); });
  bus.Subscribe<dds::topics::OperatorCommands>([this](const auto& message) { OnCommand(message); });
  bus.Every(kHeartbeat, [this] { Repeat(); });
  bus.EveryWall(kStatusPeriod, [this] { PublishStatus(); });
  bus.EveryWall(dds::MapReplica::kRequestPeriod, [this] { AskForMap(); });
  planner_ = std::jthread([this](std::stop_token stop) { RunPlanner(stop); });
}

void ExplorerService::OnMapUpdate(const thalweg_msgs::msg::MapUpdate& message) {
  Result<std::optional<dds::MapReplica::Applied>> applied = replica_.Apply(message);
  if (!applied) return bus_.health().Reject<dds::topics::MapUpdates>(applied.error());
  if (!*applied) return;
  map_stamp_ = *FromIdl(message.header().stamp());
  if ((*applied)->replaced) {
    spdlog::info("map: full copy, update {} of session {}", replica_.number(), replica_.session());
    return HandOverWholeMap();
  }
  if (planner_lacks_map_) return;  // it gets all of it later, see Repeat
  planner_lacks_map_ = !HandOver({.voxel_size = replica_.grid().voxel_size(),
                                  .changes = std::move((*applied)->changes),
                                  .scans = std::move((*applied)->scans),
                                  .stamp = map_stamp_});
}

void ExplorerService::HandOverWholeMap() {
  MapNews news{.replaced = true, .voxel_size = replica_.grid().voxel_size(), .stamp = map_stamp_};
  replica_.grid().ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    news.changes.push_back({i, log_odds});
  });
  planner_lacks_map_ = !HandOver(std::move(news));
}

bool ExplorerService::HandOver(MapNews news) {
  const std::size_t voxels = news.changes.size();
  const bool fits = inbox_.TryPush(
      [this, news = std::move(news), now = bus_.Now()](ExplorationLoop& loop) {
        if (const std::optional<Error> error = loop.OnMap(news, now)) {
          bus_.Post([this, text = error->text] { bus_.health().Reject<dds::topics::MapUpdates>(text); });
        }
      },
      voxels);
  if (!fits)
    bus_.health().Drop<dds::topics::MapUpdates>("the planner is behind and gets the whole map later");
  return fits;
}

template <class Topic>
bool ExplorerService::HandOver(PlannerInbox::Event event) {
  const bool fits = inbox_.TryPush(std::move(event));
  if (!fits) bus_.health().Drop<Topic>("the planner is behind");
  return fits;
}

void ExplorerService::OnOdometry(const nav_msgs::msg::Odometry& message) {
  const Result<dds::StampedPose> pose = FromIdl(message);
  if (!pose) return bus_.health().Reject<dds::topics::Odometry>(pose.error());
  HandOver<dds::topics::Odometry>([T_WB = pose->T](ExplorationLoop& loop) { loop.OnPose(T_WB); });
  if (!views_) return;
  views_->AddPose(*pose);
  HandOverViews();
}

template <class Message>
void ExplorerService::OnDepth(const Message& message) {
  views_->Add(message);
  HandOverViews();
}

void ExplorerService::HandOverViews() {
  for (dds::PlacedViews::View& placed : views_->Take()) {
    const std::scoped_lock lock(newest_view_mutex_);
    const bool is_known_of = newest_view_.has_value();
    newest_view_ = ViewNews{.view = {std::move(placed.stamped.cloud), placed.camera, placed.T_WB, T_BC_},
                            .stamp = placed.stamped.stamp};
    if (is_known_of) continue;  // an event that takes it is on its way
    const bool fits = inbox_.TryPush([this, topic = placed.topic](ExplorationLoop& loop) {
      std::optional<ViewNews> news;
      {
        const std::scoped_lock taking(newest_view_mutex_);
        news = std::exchange(newest_view_, std::nullopt);
      }
      if (!news) return;
      if (const std::optional<Error> error = loop.OnView(*std::move(news)))
        bus_.Post([this, topic, text = error->text] { bus_.health().Reject(topic, text); });
    });
    if (fits) continue;
    newest_view_.reset();
    bus_.health().Drop(placed.topic, "the planner is behind");
  }
}

void ExplorerService::OnOdometryStatus(const thalweg_msgs::msg::OdometryStatus& message) {
  const bool lost = message.state() == thalweg_msgs::msg::ODOMETRY_LOST;
  HandOver<dds::topics::OdometryStatus>(
      [lost, now = bus_.Now()](ExplorationLoop& loop) { loop.OnTracking(lost, now); });
}

void ExplorerService::OnMotionStatus(const thalweg_msgs::msg::MotionStatus& message) {
  const Result<Time> stamp = FromIdl(message.header().stamp());
  const Result<Time> path_stamp = FromIdl(message.path_stamp());
  if (!stamp || !path_stamp) {
    return bus_.health().Reject<dds::topics::MotionStatus>(!stamp ? stamp.error() : path_stamp.error());
  }
  if (!(message.speed_mps() >= 0.0 && std::isfinite(message.speed_mps()))) {
    return bus_.health().Reject<dds::topics::MotionStatus>(
        fmt::format("speed_mps is {}, must be >= 0", message.speed_mps()));
  }
  MotionNews news;
  news.path_id = *path_stamp;
  news.done = message.state() == thalweg_msgs::msg::MOTION_DONE;
  news.stopped = message.state() == thalweg_msgs::msg::MOTION_STOPPED;
  news.blocked = message.stop_reason() == thalweg_msgs::msg::STOP_THROUGH_SOLID ||
                 message.stop_reason() == thalweg_msgs::msg::STOP_BLOCKED;
  news.standing = message.speed_mps() == 0.0 && message.state() != thalweg_msgs::msg::MOTION_FOLLOWING;
  news.speed = message.speed_mps();
  news.stamp = *stamp;
  HandOver<dds::topics::MotionStatus>(
      [news, now = bus_.Now()](ExplorationLoop& loop) { loop.OnMotion(news, now); });
}

void ExplorerService::OnCommand(const thalweg_msgs::msg::OperatorCommand& message) {
  if (message.kind() == thalweg_msgs::msg::COMMAND_SAVE_MAP) return;  // for the mapper
  const dds::CommandId id = dds::IdOf(message);
  if (!commands_.Begin(id)) {  // sent again: answered again, but not carried out again
    if (const auto* const reply = commands_.ReplyTo(id)) replies_out_.Write(*reply);
    return;
  }
  const Result<Command> command = CommandFrom(message);
  if (!command) {
    bus_.health().Reject<dds::topics::OperatorCommands>(command.error());
    return Reply(id, {false, command.error()});
  }
  const bool fits = HandOver<dds::topics::OperatorCommands>(
      [this, id, command = *command, now = bus_.Now()](ExplorationLoop& loop) {
        bus_.Post([this, id, answer = loop.Obey(command, now)] { Reply(id, answer); });
      });
  if (!fits) Reply(id, {false, "the explorer is too busy"});
}

void ExplorerService::Reply(const dds::CommandId& id, const Answer& answer) {
  const std::string text = CleanText(AnswerText(answer));  // it may quote the command
  spdlog::info("command {} of {}: {}{}", id.number, id.sender, answer.accepted ? "" : "refused: ", text);
  const auto reply = dds::MakeReply(bus_.Now(), "explorer", id, answer.accepted, text);
  commands_.Finish(id, reply);
  replies_out_.Write(reply);
}

void ExplorerService::AskForMap() {
  if (replica_.missing()) request_out_.Write(replica_.MakeRequest(bus_.Now(), "explorer"));
}

void ExplorerService::Repeat() {
  if (planner_lacks_map_ && inbox_.empty()) HandOverWholeMap();
  inbox_.TryPush([](ExplorationLoop&) {});  // budgets must run out even when no messages arrive
  PublishOrder();
}

void ExplorerService::PublishOrder() {
  if (order_) path_out_.Write(ToIdl(dds::StampedPath{order_->id, order_->T_WBs}));
}

void ExplorerService::PostOrder() {
  bus_.Post([this, order = loop_.order()] {
    order_ = order;
    PublishOrder();
  });
}

void ExplorerService::PublishStatus() {
  status_.header(dds::MakeHeader(bus_.Now(), dds::kMapFrame));
  status_out_.Write(status_);
  PublishMarkers();  // to those who joined since the last plan
}

void ExplorerService::PublishMarkers() {
  if (!markers_due_ || markers_out_.readers() == 0) return;
  markers_due_ = false;
  markers_out_.Write(MarkersOf(frontiers_));
}

void ExplorerService::RunPlanner(std::stop_token stop) try {
  while (!stop.stop_requested()) {
    const std::deque<PlannerInbox::Event> events = inbox_.Take(stop);
    if (events.empty()) return;
    const Time heard = bus_.Now();
    const Time before = loop_.order() ? loop_.order()->id : Time{};
    for (const PlannerInbox::Event& event : events) event(loop_);
    // What the robot must hear before the next decision, which takes long.
    if (loop_.order() && loop_.order()->id != before) PostOrder();
    const std::size_t plans_before = loop_.explorer().plans();
    const bool changed = loop_.Think(bus_.Now());
    if (changed) PostOrder();
    if (loop_.explorer().plans() != plans_before && loop_.explorer().planned_in_flight())
      loop_.NoteDecisionTime(Seconds(bus_.Now() - heard));
    CountBeyondLimit();
    PublishThoughts();
    LogInterruptions();
    SaveWhenDue();
    std::string activity = ActivityText(loop_, sensor_range_);
    if (!changed && activity == activity_) continue;
    activity_ = std::move(activity);
    const std::size_t plans = loop_.explorer().plans();
    if (std::exchange(plans_noted_, plans) != plans) {
      for (const std::string& note : loop_.plan().notes) spdlog::info("{}", note);
    }
    spdlog::info("{}", activity_);
    if (const auto& ending = loop_.plan().ending; ending && ending->outcome == Outcome::kTooMuchUnknown) {
      spdlog::warn(
          "if the sensor reports where nothing is within its range, as lidars and time-of-flight cameras do, "
          "set depth_sensor.no_return_is_free");
    }
    bus_.Post([this, status = MakeStatus()] {
      status_ = status;
      PublishStatus();
    });
  }
} catch (const std::exception&) {
  // Rethrow from Spin, on the main thread, where main catches it.
  bus_.Post([error = std::current_exception()] { std::rethrow_exception(error); });
}

void ExplorerService::CountBeyondLimit() {
  const std::size_t beyond = loop_.explorer().map().beyond_limit();
  if (beyond == std::exchange(beyond_limit_, beyond)) return;
  bus_.Post([this, beyond] {
    bus_.health().Drop<dds::topics::MapUpdates>(
        std::to_string(beyond) + " voxels are too far for the planner's box; limit it by world.bounds");
  });
}

void ExplorerService::Continue() {
  if (file_.path.empty() || !std::filesystem::exists(file_.path)) return;
  const Result<SavedExploration> saved = LoadExploration(file_.path);
  if (!saved) {
    spdlog::error("{}; the exploration starts over", saved.error());
    return;
  }
  if (saved->place != file_.place) {
    spdlog::error("{}: is of another exploration, {}, not of {}; the exploration starts over",
                  file_.path.string(), CleanText(saved->place), file_.place);
    return;
  }
  loop_.Restore(*saved);
  spdlog::warn("continues the exploration that {} was saved from: {:.1f} m traveled, {} no-go boxes drawn{}",
               file_.path.string(), saved->distance, saved->drawn.size(),
               saved->paused ? "; paused: " + PauseText(*saved->paused) : "");
}

/// Saves what was commanded at once, everything else now and then.
void ExplorerService::SaveWhenDue() {
  if (file_.path.empty()) return;
  const Explorer::Standing standing = loop_.explorer().standing();
  std::string commands =
      fmt::format("{} {} {} {} {}", loop_.state() == LoopState::kPaused || loop_.state() == LoopState::kDone,
                  standing.homeward, standing.gone_tight_way, standing.ignored, standing.strategy);
  for (const Eigen::AlignedBox3d& box_W : standing.drawn_no_go) {
    for (const double number : {box_W.min().x(), box_W.min().y(), box_W.min().z(), box_W.max().x(),
                                box_W.max().y(), box_W.max().z()}) {
      commands += fmt::format(" {}", number);
    }
  }
  if (commands == saved_commands_ && since_saved_ && since_saved_->Milliseconds() < kSavePeriodMs) return;
  since_saved_.emplace();
  saved_commands_ = std::move(commands);
  try {
    SavedExploration saved = loop_.Save(bus_.Now());
    saved.place = file_.place;
    WriteFile(file_.path, EncodeExploration(saved));
    save_fails_ = false;
  } catch (const std::exception& error) {
    if (!std::exchange(save_fails_, true))
      spdlog::error("{}; should the explorer be restarted, it will not know its mission", error.what());
  }
}

void ExplorerService::Forget() {
  std::error_code ignored;
  if (!file_.path.empty()) std::filesystem::remove(file_.path, ignored);
}

void ExplorerService::LogInterruptions() {
  for (const auto& [reason, plans] : loop_.interruptions()) {
    if (std::exchange(interruptions_logged_[reason], plans) != plans)
      spdlog::info("plan interrupted: {}", InterruptionText(reason));
  }
}

/// Publishes what the last plan was based on, once per plan. Runs on the planner's thread, which publishers
/// allow.
void ExplorerService::PublishThoughts() {
  const Explorer& explorer = loop_.explorer();
  const std::size_t plans = explorer.plans();
  if (plans == std::exchange(plans_published_, plans)) return;
  const Time now = bus_.Now();
  thalweg_msgs::msg::FrontierList list;
  list.header(dds::MakeHeader(now, dds::kMapFrame));
  list.strategy(explorer.standing().strategy);
  for (const FrontierReport& report : explorer.frontier_reports()) {
    list.frontiers().push_back(ToIdl(report));
  }
  frontiers_out_.Write(list);
  bus_.Post([this, list] {
    frontiers_ = list;
    markers_due_ = true;
    PublishMarkers();
  });
  dds::StampedPath streamline{now, {}};
  for (const Eigen::Vector3d& p_W : explorer.chosen_path_W()) {
    streamline.T_WBs.push_back(MakeTransform(Eigen::Matrix3d::Identity(), p_W));
  }
  streamline_out_.Write(dds::ToIdl(streamline));
  const DenseGrid<float>* const field = explorer.field();
  if (field == nullptr) return;
  if (field_out_.readers() > 0) field_out_.Write(dds::ToIdl(now, PointsOf(*field, explorer.map())));
  if (sealed_out_.readers() > 0)
    sealed_out_.Write(dds::ToIdl(now, PointsOf(explorer.sealed(), explorer.map())));
}

thalweg_msgs::msg::ExplorationStatus ExplorerService::MakeStatus() const {
  const Explorer::Status status = loop_.explorer().status();
  const Explorer::Standing standing = loop_.explorer().standing();
  thalweg_msgs::msg::ExplorationStatus message;
  message.strategy(standing.strategy);
  message.state(ToIdl(loop_.state()));
  const Plan& plan = loop_.plan();
  message.outcome(thalweg_msgs::msg::OUTCOME_NONE);
  if (plan.ending) {
    message.outcome(ToIdl(plan.ending->outcome));
    message.homeward(plan.homeward.has_value());
    message.home_within_budget(plan.ending->home_within_budget);
    message.stop_reason(EndingText(*plan.ending));
    message.stop_details(DetailsText(*plan.ending, sensor_range_));
  } else if (plan.homeward) {
    message.outcome(ToIdl(*plan.homeward));
    message.homeward(true);
  }
  message.activity(ActivityText(loop_, sensor_range_));
  message.target(ToPoint(plan.target_W));
  message.frontiers_left(static_cast<std::uint32_t>(status.frontiers_left));
  message.frontier_voxels_left(static_cast<std::uint32_t>(status.frontier_voxels_left));
  for (const SetAsideCount& count : status.set_aside) {
    thalweg_msgs::msg::SetAside& aside = message.set_aside().emplace_back();
    aside.reason(ToIdl(count.reason));
    aside.doubtful(count.doubtful);
    aside.clusters(static_cast<std::uint32_t>(count.clusters));
    aside.voxels(static_cast<std::uint32_t>(count.voxels));
  }
  message.plans(static_cast<std::uint32_t>(status.plans));
  message.replans(static_cast<std::uint32_t>(loop_.replans()));
  for (const auto& [reason, plans] : loop_.interruptions()) {
    thalweg_msgs::msg::InterruptionCount& count = message.interruptions().emplace_back();
    count.reason(ToIdl(reason));
    count.plans(static_cast<std::uint32_t>(plans));
  }
  if (const auto& last = loop_.last_interruption())
    message.last_interruption(std::string(InterruptionText(*last)));
  message.distance_m(status.distance);
  for (const Eigen::AlignedBox3d& box_W : standing.drawn_no_go) {
    thalweg_msgs::msg::NoGoBox& box = message.no_go().emplace_back();
    box.min(ToPoint(box_W.min()));
    box.max(ToPoint(box_W.max()));
  }
  for (const auto& [stage, timing] : status.timings) message.timings().push_back(ToIdl(stage, timing));
  return message;
}

}  // namespace thalweg::explorer
