#include "services/cli/process/port_announcement.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>

namespace thalweg::cli {
namespace {

/// The port that comes out of a pipe; nothing if the pipe is closed before the end of the line.
std::optional<int> PortFrom(int pipe) {
  std::string text;
  char character = 0;
  while (read(pipe, &character, 1) == 1 && character != '\n') text += character;
  return character == '\n' ? std::optional(std::stoi(text)) : std::nullopt;
}

}  // namespace

std::string WhenPortIsAnnounced(const std::function<void(int port)>& act) {
  std::array<int, 2> announcement{};
  if (pipe(announcement.data()) != 0) {
    throw std::runtime_error(std::string("no pipe for the gateway's port: ") + std::strerror(errno));
  }
  const auto [out, in] = announcement;
  const pid_t child = fork();
  if (child == 0) {
    close(in);
    // The grandchild belongs to nobody who would have to wait for it.
    if (fork() == 0) {
      if (const auto port = PortFrom(out)) act(*port);
    }
    _exit(0);
  }
  close(out);
  waitpid(child, nullptr, 0);
  return "/dev/fd/" + std::to_string(in);
}

}  // namespace thalweg::cli
