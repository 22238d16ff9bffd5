#pragma once

#include <functional>
#include <string>

#include "services/gateway/adapter/options.h"

namespace thalweg::cli {

/// Whether a page opens on the screen of whoever typed the command: there is a display, xdg-open, and no ssh
/// between. Elsewhere the address is only printed.
/// @param at_terminal  Whether the command was typed rather than started by a program.
bool HasBrowser(bool at_terminal);

/// Opens a page without waiting for it. What goes wrong is nobody's concern: the address has been printed.
/// The address stands in a list of processes that every user can read, so that it must hold no token.
void OpenInBrowser(const std::string& url);

/// Says where a run is shown, "Open http://127.0.0.1:8765/ to see the run.", and opens the page if it was
/// built, needs no token, and there is a browser.
/// @param listen       With the port on which the gateway serves.
/// @param purpose      What follows the address, if the page was built: "to see the run."
/// @param at_terminal  As for HasBrowser.
/// @param say          Prints the text, before the page opens.
void ShowPage(const gateway::ListenOptions& listen, const std::string& purpose, bool at_terminal,
              const std::function<void(const std::string& text)>& say);

}  // namespace thalweg::cli
