#pragma once

#include <functional>
#include <string>

namespace thalweg::cli {

/// Starts a process that waits until a port is announced and then calls `act` with it, so that this process
/// can become the program that announces the port. Where that program ends before, nothing is called. Nobody
/// has to wait for the process that was started.
/// @return  The file in which the port is to be announced, as a line. It stays open in a program that this
/// process becomes.
/// Throws std::runtime_error if the system has no more pipes.
std::string WhenPortIsAnnounced(const std::function<void(int port)>& act);

}  // namespace thalweg::cli
