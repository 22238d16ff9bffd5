#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

#include "common/base/option_visitor.h"

namespace thalweg::test {

/// Records the fields that a binding visits, and sets the options of those that it was given a value for.
class RecordingVisitor final : public OptionVisitor {
 public:
  using Value = std::variant<double, std::int64_t, bool, std::string, std::array<double, 3>>;

  /// @param path  "flow.eagerness"
  void Give(const std::string& path, const Value& value) { given_[path] = value; }

  /// Paths of all fields visited, in that order, blocks themselves not among them.
  const std::vector<std::string>& fields() const { return fields_; }

 private:
  template <class Option>
  bool Record(const char* field, Option& option) {
    fields_.push_back(prefix_ + field);
    const auto given = given_.find(fields_.back());
    if (given == given_.end()) return false;
    option = std::get<Option>(given->second);
    return true;
  }
  bool VisitNumber(const char* field, double& value) override { return Record(field, value); }
  bool VisitWhole(const char* field, std::int64_t& value) override { return Record(field, value); }
  bool VisitSwitch(const char* field, bool& value) override { return Record(field, value); }
  bool VisitText(const char* field, std::string& value) override { return Record(field, value); }
  bool VisitVector(const char* field, std::array<double, 3>& value) override { return Record(field, value); }
  void VisitBlock(const char* field, const std::function<void(OptionVisitor&)>& visit) override {
    const std::string outer = prefix_;
    prefix_ += std::string(field) + '.';
    visit(*this);
    prefix_ = outer;
  }

  std::map<std::string, Value> given_;
  std::vector<std::string> fields_;
  std::string prefix_;
};

}  // namespace thalweg::test
