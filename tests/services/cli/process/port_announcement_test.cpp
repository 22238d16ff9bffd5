#include "services/cli/process/port_announcement.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <fstream>

namespace thalweg::cli {
namespace {

/// What the process that waits for a port does with the text that is announced to it.
std::string ActionOn(const std::string& announcement) {
  std::array<int, 2> action{};
  EXPECT_EQ(pipe2(action.data(), O_CLOEXEC), 0);
  const auto [out, in] = action;
  const std::string file = WhenPortIsAnnounced([&](int port) {
    const std::string text = "port " + std::to_string(port);
    EXPECT_EQ(write(action[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  });
  close(in);
  std::ofstream(file) << announcement << std::flush;
  close(std::stoi(file.substr(file.rfind('/') + 1)));  // as it is at the end of a program
  std::string text;
  for (char character = 0; read(out, &character, 1) == 1;) text += character;
  close(out);
  return text;
}

TEST(PortAnnouncement, APortThatIsAnnouncedIsActedOn) {
  EXPECT_EQ(ActionOn("8765\n"), "port 8765");
}

TEST(PortAnnouncement, WhereAProgramEndsBeforeNothingHappens) {
  EXPECT_EQ(ActionOn(""), "");
  EXPECT_EQ(ActionOn("87"), "");
}

}  // namespace
}  // namespace thalweg::cli
