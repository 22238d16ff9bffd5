#include "services/gateway/adapter/parameters.h"

#include <google/protobuf/text_format.h>

#include <string>

#include "common/service/shared_options.h"

namespace thalweg::gateway {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

void Collect(const Message& message, const std::string& path, std::vector<Parameter>& parameters) {
  const Reflection& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  for (const FieldDescriptor* const field : fields) {
    const bool nested = field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
    for (int n = 0; n < count; ++n) {
      std::string name = path + field->name();
      if (field->is_repeated()) name.append(".").append(std::to_string(n));
      if (nested) {
        Collect(field->is_repeated() ? reflection.GetRepeatedMessage(message, field, n)
                                     : reflection.GetMessage(message, field),
                name + ".", parameters);
        continue;
      }
      // Text format writes numbers, true and false as JSON does; the names of choices become texts.
      std::string value;
      const int index = field->is_repeated() ? n : -1;
      google::protobuf::TextFormat::PrintFieldValueToString(message, field, index, &value);
      parameters.push_back({name, value});
    }
  }
}

}  // namespace

std::vector<Parameter> ParametersOf(const Scenario& scenario) {
  std::vector<Parameter> parameters;
  Collect(WithSharedDefaults(scenario), "", parameters);
  return parameters;
}

}  // namespace thalweg::gateway
