#include "services/cli/report/warning_filter.h"

namespace thalweg::cli {

bool WarningFilter::AdmitReported(const std::string& text) {
  if (reported_ >= kMost || shown_.contains(text)) return false;
  std::size_t& of_kind = of_kind_[text.substr(0, text.find(": "))];
  if (of_kind >= kMostOfAKind) return false;
  ++of_kind;
  ++reported_;
  shown_.insert(text);
  return true;
}

}  // namespace thalweg::cli
