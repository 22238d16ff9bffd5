#include "services/evaluator/text/run_end_text.h"

#include "common/base/check.h"
#include "services/explorer/text/outcome_text.h"

namespace thalweg::evaluator {

std::string ToText(const RunEnd& end) {
  switch (end.kind) {
    case RunEnd::Kind::kExplorer:
      return explorer::EndingText(end.ending);
    case RunEnd::Kind::kCutOff:
      return "cut off";
    case RunEnd::Kind::kInterrupted:
      return "interrupted";
    case RunEnd::Kind::kLost:
      return "lost";
    case RunEnd::Kind::kFlown:
      return "end of the trajectory";
  }
  THALWEG_CHECK(false);
  return {};
}

}  // namespace thalweg::evaluator
