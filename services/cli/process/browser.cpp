#include "services/cli/process/browser.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <sstream>

#include "common/base/environment.h"
#include "services/gateway/adapter/page_files.h"

namespace thalweg::cli {
namespace {

constexpr auto kOpener = "xdg-open";

bool IsSet(const char* variable) {
  return !Environment(variable).empty();
}

bool IsInPath(const std::string& program) {
  std::istringstream folders(Environment("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((folder + '/' + program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

}  // namespace

bool HasBrowser(bool at_terminal) {
  const bool has_display = IsSet("DISPLAY") || IsSet("WAYLAND_DISPLAY");
  const bool is_remote = IsSet("SSH_CONNECTION") || IsSet("SSH_TTY");
  return at_terminal && has_display && !is_remote && IsInPath(kOpener);
}

void OpenInBrowser(const std::string& url) {
  const pid_t child = fork();
  if (child == 0) {
    setsid();  // Ctrl-C at the terminal is not meant for the browser
    if (fork() != 0) _exit(0);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    const int nowhere = open("/dev/null", O_RDWR);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
    execlp(kOpener, kOpener, url.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  if (child > 0) waitpid(child, nullptr, 0);
}

void ShowPage(const gateway::ListenOptions& listen, const std::string& purpose, bool at_terminal,
              const std::function<void(const std::string& text)>& say) {
  const std::string url = gateway::UrlOf(listen);
  if (!gateway::HasPage()) return say(gateway::NoPageText(url));
  say("Open " + url + " " + purpose);
  if (listen.token.empty() && HasBrowser(at_terminal)) OpenInBrowser(url);
}

}  // namespace thalweg::cli
