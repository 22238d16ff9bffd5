#pragma once

#include <google/protobuf/message.h>

#include "common/base/option_visitor.h"

namespace thalweg {

/// Sets the options whose fields are present in a block of a scenario, and leaves the others alone.
/// A field that the block's message does not have, or that has another type, is our own bug: it aborts.
class OptionReader final : public OptionVisitor {
 public:
  /// @param block  Outlives the reader.
  explicit OptionReader(const google::protobuf::Message& block) : block_(block) {}

 private:
  bool VisitNumber(const char* field, double& value) override;
  bool VisitWhole(const char* field, std::int64_t& value) override;
  bool VisitSwitch(const char* field, bool& value) override;
  bool VisitText(const char* field, std::string& value) override;
  bool VisitVector(const char* field, std::array<double, 3>& value) override;
  void VisitBlock(const char* field, const std::function<void(OptionVisitor&)>& visit) override;

  const google::protobuf::Message& block_;
};

/// Writes the options into a block of a scenario where their fields are absent, and changes no option.
/// Numbers are written with seven digits: the decimals that were meant, before they became floats or radians.
/// A field that the block's message does not have, or that has another type, is our own bug: it aborts.
class OptionWriter final : public OptionVisitor {
 public:
  /// @param block  Outlives the writer.
  explicit OptionWriter(google::protobuf::Message& block) : block_(block) {}

 private:
  bool VisitNumber(const char* field, double& value) override;
  bool VisitWhole(const char* field, std::int64_t& value) override;
  bool VisitSwitch(const char* field, bool& value) override;
  bool VisitText(const char* field, std::string& value) override;
  bool VisitVector(const char* field, std::array<double, 3>& value) override;
  void VisitBlock(const char* field, const std::function<void(OptionVisitor&)>& visit) override;

  google::protobuf::Message& block_;
};

/// The options, with what is present in a block of a scenario over them.
template <class Options>
void ReadOptions(const google::protobuf::Message& block, Options& options) {
  OptionReader reader(block);
  Visit(reader, options);
}

}  // namespace thalweg
