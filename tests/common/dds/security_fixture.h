#pragma once

#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/dds/bus.h"
#include "tests/support/security_keys.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {

inline BusOptions Secure(const std::string& role, const test::KeyFolder& keys, bool shared_memory = false) {
  BusOptions options = test::BusOptionsForTest(role);
  options.shared_memory = shared_memory;
  options.security_dir = keys.path().string();
  return options;
}

inline BusOptions WithoutKeys(const std::string& name) {
  BusOptions options = test::BusOptionsForTest(name);
  options.shared_memory = false;
  return options;
}

/// Tests with keys, in which each bus hears the others over the network.
class Security : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::HasOpenssl()) GTEST_SKIP() << "openssl is not installed";
    // Buses of one process would otherwise hand over messages directly, as two machines do not.
    eprosima::fastrtps::LibrarySettingsAttributes settings;
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
  }
};

inline nav_msgs::msg::Path PathNamed(const std::string& name) {
  nav_msgs::msg::Path path;
  path.header().frame_id(name);
  return path;
}

/// A controller that notes the names of the paths that it hears.
struct Controller {
  explicit Controller(const BusOptions& options) : bus(options) {
    bus.Subscribe<topics::Path>([this](const auto& path) { heard.push_back(path.header().frame_id()); });
  }
  bool Hears(const std::string& name) {
    return bus.SpinUntil([&] { return std::ranges::find(heard, name) != heard.end(); }, test::kPatience);
  }
  Bus bus;
  std::vector<std::string> heard;
};

}  // namespace thalweg::dds
