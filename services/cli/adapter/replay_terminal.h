#pragma once

#include <ostream>
#include <stop_token>
#include <string>
#include <string_view>

#include "services/recorder/adapter/player.h"

namespace thalweg::cli {

/// What the keys do, for people.
inline constexpr const char* kReplayKeys =
    "Enter: pause; left, right: 5 s back, forward; -, +: slower, faster";

/// Does what the keys in `typed` say, in the bytes that a terminal sends for them; any others do nothing.
void Obey(recorder::Player& player, std::string_view typed);

/// Where a replay is, on a line of a terminal: "0:12 / 3:00  2x  paused".
std::string ProgressText(const recorder::Player::Progress& its);

/// Whether this process may use a terminal as its own: what a shell has put into the background is stopped if
/// it reads from it or sets it. True for what is no terminal, or none that a shell shares out.
bool IsInForeground(int terminal);

/// Obeys the keys of standard input, a terminal, until `ended`, while it is in the foreground. Then it gives
/// each key at once and does not show it.
void FollowKeys(recorder::Player& player, const std::stop_token& ended);

/// Keeps a line of the terminal that says where the replay is, until `ended`, while it is in the foreground.
void ShowProgress(const recorder::Player& player, std::ostream& out, const std::stop_token& ended);

}  // namespace thalweg::cli
