#pragma once

#include "common/base/option_visitor.h"
#include "services/explorer/core/strategy/flow.h"

namespace thalweg::explorer {

/// Our own strategy for inspection: sees all surface from near and squarely enough, not only all space.
///
/// Space is explored as by Flow, with the options of the block `flow`. What surface is known is inspected on
/// a tour through all of it, in which the frontier that Flow chose is a stop, too (InspectionTour). What was
/// inspected is not saved: an explorer that is restarted, or given a new map, inspects again.
class Surface final : public Strategy {
 public:
  using Options = InspectionOptions;
  Surface(const Options& options, const Flow::Options& flow) : options_(options), flow_(flow) {}
  Choice Choose(const Situation& situation) override { return flow_.Choose(situation); }
  const InspectionOptions* inspection() const override { return &options_; }

 private:
  Options options_;
  Flow flow_;
};

void Visit(OptionVisitor& visitor, Surface::Options& options);  ///< Block `surface`.

}  // namespace thalweg::explorer
