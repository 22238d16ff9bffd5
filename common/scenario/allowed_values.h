#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <string>
#include <vector>

namespace thalweg {

/// A field's path, from the scenario inward.
using FieldPath = std::vector<const google::protobuf::FieldDescriptor*>;
std::string ToString(const FieldPath& path);  ///< "mapper.voxel_size_m"

/// The type of a field's values in words: "a number", "true or false", "one of Z, Y".
std::string TypeText(const google::protobuf::FieldDescriptor* field);
/// The allowed numbers or names: "in (0, 10] m", "one of closest, potential".
std::string AllowedText(const FieldPath& path);

/// The error for a name that is not among `names`: 'is "clsest", must be one of closest, flow; did you mean
/// closest?'
std::string NotOneOf(const std::vector<std::string>& names, const std::string& name);

/// What is wrong with the value of the last field of `path`, which is present in `message`: it is not
/// allowed, or names an output of the service itself. Empty if nothing is.
std::string WrongValueText(const google::protobuf::Message& message, const FieldPath& path);

/// Whether `value` lies in an interval such as "(0, 10]"; false for NaN.
bool IsInInterval(double value, const std::string& interval);

}  // namespace thalweg
