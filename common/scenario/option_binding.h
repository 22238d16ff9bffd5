#pragma once

#include <google/protobuf/message.h>

#include "common/base/option_visitor.h"

namespace thalweg {

/// Sets the options whose fields are present in a block of a scenario, and leaves the others unchanged. A
/// field that the block's message lacks, or that has another type, is a bug of ours: it aborts.
class OptionReader final : public OptionVisitor {
 public:
  /// @param block  Must outlive the reader.
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

/// Writes the options whose fields are absent into a block of a scenario; changes no option. Numbers are
/// rounded to seven digits, to recover the decimals that were meant before they became floats or radians. A
/// field that the block's message lacks, or that has another type, is a bug of ours: it aborts.
class OptionWriter final : public OptionVisitor {
 public:
  /// @param block  Must outlive the writer.
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

/// Overwrites the options whose fields are present in a block of a scenario.
template <class Options>
void ReadOptions(const google::protobuf::Message& block, Options& options) {
  OptionReader reader(block);
  Visit(reader, options);
}

/// The options of a block, with the defaults of their struct where the block has no field.
template <class Options>
Options ReadOptions(const google::protobuf::Message& block) {
  Options options;
  ReadOptions(block, options);
  return options;
}

}  // namespace thalweg
