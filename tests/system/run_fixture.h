#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/system/processes.h"

namespace thalweg::test {

/// `thalweg run tiny` as typed by a user, observed over the bus.
class RunSystemTest : public testing::Test {
 protected:
  RunSystemTest() {
    bus_.Subscribe<dds::topics::Health>(
        [this](const auto& message) { pids_[message.service()] = static_cast<pid_t>(message.process_id()); });
    bus_.Subscribe<dds::topics::ExplorationStatus>([this](const auto& message) { exploration_ = message; });
    bus_.Subscribe<dds::topics::SimulationStatus>([this](const auto& message) { simulation_ = message; });
  }

  void Start(const std::vector<std::string>& more = {}) { StartScenario("tiny", more); }
  void StartScenario(const std::string& scenario, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"run", scenario, "--out", Out()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run_.emplace("thalweg", arguments, Screen());
  }
  std::filesystem::path Out() const { return place_.folder() / "out"; }
  std::filesystem::path Screen() const { return place_.folder() / "screen.txt"; }

  bool Until(const std::function<bool()>& done) {
    return bus_.SpinUntil([&] { return done() || run_->ended(); }, std::chrono::seconds(60)) && done();
  }
  /// Whether the exploration is under way: part of the room has been seen, part has not.
  bool OnTheWay() const {
    return simulation_ && simulation_->distance_m() > 0.2 && exploration_ &&
           exploration_->state() != thalweg_msgs::msg::EXPLORATION_DONE;
  }
  /// Throws if the service is not heard: 0 would be taken for the process group of the test.
  pid_t PidOf(const std::string& service) {
    if (!Until([&] { return pids_.contains(service); })) throw std::runtime_error(service + " was not heard");
    return pids_.at(service);
  }

  void ExpectComplete(double least_agreement = 0.97) {
    const auto status = run_->WaitForEnd(std::chrono::seconds(200));
    ASSERT_TRUE(status) << "it still runs; " << Printed();
    EXPECT_TRUE(WIFEXITED(*status) && WEXITSTATUS(*status) == 0) << cli::DescribeEnd(*status) << "\n"
                                                                 << Printed();
    const auto report = Report();
    EXPECT_EQ(report["stop_reason"], "complete");
    EXPECT_EQ(report["true_collisions"], 0);
    ASSERT_TRUE(report["agreement"].is_number());
    EXPECT_GE(report["agreement"], least_agreement);
  }
  nlohmann::json Report() const { return nlohmann::json::parse(std::ifstream(Out() / "report.json")); }
  std::string Printed() const {
    std::ostringstream text;
    text << std::ifstream(Screen()).rdbuf();
    return text.str();
  }

  OwnPlace place_;
  dds::Bus bus_{place_.BusOptions()};
  std::map<std::string, pid_t> pids_;
  std::optional<thalweg_msgs::msg::ExplorationStatus> exploration_;
  std::optional<thalweg_msgs::msg::SimulationStatus> simulation_;
  std::optional<RunningProgram> run_;
};

}  // namespace thalweg::test
