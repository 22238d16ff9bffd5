#include "common/scenario/option_binding.h"

#include <cstdio>
#include <cstdlib>

#include "scenario.pb.h"

namespace thalweg {
namespace {

using google::protobuf::EnumValueDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

const FieldDescriptor* FieldOf(const Message& block, const char* name, FieldDescriptor::CppType type) {
  const FieldDescriptor* const field = block.GetDescriptor()->FindFieldByName(name);
  const bool bound_to_the_schema = field != nullptr && field->cpp_type() == type && !field->is_repeated();
  if (!bound_to_the_schema) {
    std::fprintf(stderr, "option %s: no such field of that type in %s\n", name,
                 block.GetDescriptor()->full_name().c_str());
  }
  THALWEG_CHECK(bound_to_the_schema);
  return field;
}

/// Returns a text field, or an enum field, whose values have names.
const FieldDescriptor* TextFieldOf(const Message& block, const char* name) {
  const FieldDescriptor* const field = block.GetDescriptor()->FindFieldByName(name);
  const bool choice = field != nullptr && field->cpp_type() == FieldDescriptor::CPPTYPE_ENUM;
  return choice ? field : FieldOf(block, name, FieldDescriptor::CPPTYPE_STRING);
}

const FieldDescriptor* VectorFieldOf(const Message& block, const char* name) {
  const FieldDescriptor* const field = FieldOf(block, name, FieldDescriptor::CPPTYPE_MESSAGE);
  THALWEG_CHECK(field->message_type() == Vector3::descriptor());
  return field;
}

double ToSevenDigits(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.7g", value);
  return std::strtod(text.data(), nullptr);
}

}  // namespace

bool OptionReader::VisitNumber(const char* name, double& value) {
  const FieldDescriptor* const field = FieldOf(block_, name, FieldDescriptor::CPPTYPE_DOUBLE);
  const Reflection& reflection = *block_.GetReflection();
  if (!reflection.HasField(block_, field)) return false;
  value = reflection.GetDouble(block_, field);
  return true;
}

bool OptionReader::VisitWhole(const char* name, std::int64_t& value) {
  const FieldDescriptor* const field = FieldOf(block_, name, FieldDescriptor::CPPTYPE_INT32);
  const Reflection& reflection = *block_.GetReflection();
  if (!reflection.HasField(block_, field)) return false;
  value = reflection.GetInt32(block_, field);
  return true;
}

bool OptionReader::VisitSwitch(const char* name, bool& value) {
  const FieldDescriptor* const field = FieldOf(block_, name, FieldDescriptor::CPPTYPE_BOOL);
  const Reflection& reflection = *block_.GetReflection();
  if (!reflection.HasField(block_, field)) return false;
  value = reflection.GetBool(block_, field);
  return true;
}

bool OptionReader::VisitText(const char* name, std::string& value) {
  const FieldDescriptor* const field = TextFieldOf(block_, name);
  const Reflection& reflection = *block_.GetReflection();
  if (!reflection.HasField(block_, field)) return false;
  value = field->cpp_type() == FieldDescriptor::CPPTYPE_ENUM ? reflection.GetEnum(block_, field)->name()
                                                             : reflection.GetString(block_, field);
  return true;
}

bool OptionReader::VisitVector(const char* name, std::array<double, 3>& value) {
  const FieldDescriptor* const field = VectorFieldOf(block_, name);
  const Reflection& reflection = *block_.GetReflection();
  if (!reflection.HasField(block_, field)) return false;
  const auto& vector = static_cast<const Vector3&>(reflection.GetMessage(block_, field));
  value = {vector.x(), vector.y(), vector.z()};
  return true;
}

void OptionReader::VisitBlock(const char* name, const std::function<void(OptionVisitor&)>& visit) {
  const FieldDescriptor* const field = FieldOf(block_, name, FieldDescriptor::CPPTYPE_MESSAGE);
  OptionReader inner(block_.GetReflection()->GetMessage(block_, field));
  visit(inner);
}

bool OptionWriter::VisitNumber(const char* name, double& value) {
  const FieldDescriptor* const field = FieldOf(block_, name, FieldDescriptor::CPPTYPE_DOUBLE);
  const Reflection& reflection = *block_.GetReflection();
  if (!reflection.HasField(block_, field)) reflection.SetDouble(&block_, field, ToSevenDigits(value));
  return false;
}

bool OptionWriter::VisitWhole(const char* name, std::int64_t& value) {
  const FieldDescriptor* const field = FieldOf(block_, name, FieldDescriptor::CPPTYPE_INT32);
  const Reflection& reflection = *block_.GetReflection();
  if (!reflection.HasField(block_, field)) {
    reflection.SetInt32(&block_, field, static_cast<std::int32_t>(value));
  }
  return false;
}

bool OptionWriter::VisitSwitch(const char* name, bool& value) {
  const FieldDescriptor* const field = FieldOf(block_, name, FieldDescriptor::CPPTYPE_BOOL);
  const Reflection& reflection = *block_.GetReflection();
  if (!reflection.HasField(block_, field)) reflection.SetBool(&block_, field, value);
  return false;
}

bool OptionWriter::VisitText(const char* name, std::string& value) {
  const FieldDescriptor* const field = TextFieldOf(block_, name);
  const Reflection& reflection = *block_.GetReflection();
  if (reflection.HasField(block_, field)) return false;
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
    reflection.SetString(&block_, field, value);
  } else {
    const EnumValueDescriptor* const choice = field->enum_type()->FindValueByName(value);
    THALWEG_CHECK(choice != nullptr);
    reflection.SetEnum(&block_, field, choice);
  }
  return false;
}

bool OptionWriter::VisitVector(const char* name, std::array<double, 3>& value) {
  const FieldDescriptor* const field = VectorFieldOf(block_, name);
  const Reflection& reflection = *block_.GetReflection();
  if (reflection.HasField(block_, field)) return false;
  auto& vector = static_cast<Vector3&>(*reflection.MutableMessage(&block_, field));
  vector.set_x(ToSevenDigits(value[0]));
  vector.set_y(ToSevenDigits(value[1]));
  vector.set_z(ToSevenDigits(value[2]));
  return false;
}

void OptionWriter::VisitBlock(const char* name, const std::function<void(OptionVisitor&)>& visit) {
  const FieldDescriptor* const field = FieldOf(block_, name, FieldDescriptor::CPPTYPE_MESSAGE);
  OptionWriter inner(*block_.GetReflection()->MutableMessage(&block_, field));
  visit(inner);
}

}  // namespace thalweg
