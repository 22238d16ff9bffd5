#pragma once

#include <string>

namespace thalweg::cli {

/// Whether a page opens on the screen of whoever typed the command: there is a display, xdg-open, and no ssh
/// between. Elsewhere the address is only printed.
/// @param at_terminal  Whether the command was typed rather than started by a program.
bool HasBrowser(bool at_terminal);

/// Opens a page without waiting for it. What goes wrong is nobody's concern: the address has been printed.
/// The address stands in a list of processes that every user can read, so that it must hold no token.
void OpenInBrowser(const std::string& url);

}  // namespace thalweg::cli
