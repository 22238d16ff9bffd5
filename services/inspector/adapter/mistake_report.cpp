#include "services/inspector/adapter/mistake_report.h"

#include <fmt/format.h>

namespace thalweg::inspector {

void MistakeReport::Look() {
  if (listener_.malformed() == 0 || shown_) return;
  shown_ = true;
  say_("malformed message: " + listener_.last_error());
}

MistakeReport::~MistakeReport() {
  Look();
  if (listener_.malformed() > 1) {
    say_(fmt::format("{} of {} messages were malformed; the last: {}", listener_.malformed(),
                     listener_.received(), listener_.last_error()));
  }
}

}  // namespace thalweg::inspector
