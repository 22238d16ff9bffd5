#include "services/inspector/core/field_path.h"

#include <algorithm>
#include <charconv>

namespace thalweg::inspector {
namespace {

std::string FieldsOf(const MessageType& message) {
  std::string names;
  for (const Field& field : message.fields) names += (names.empty() ? "" : ", ") + field.name;
  return names;
}

}  // namespace

Result<FieldPath> FieldPath::Parse(const Schema& schema, std::string_view path) {
  FieldPath out;
  out.type_ = schema.root();
  std::string name;
  while (!path.empty()) {
    if (path[0] == '[') {
      std::size_t index = 0;
      const auto [rest, error] = std::from_chars(path.data() + 1, path.data() + path.size(), index);
      if (error != std::errc() || rest == path.data() + path.size() || *rest != ']') {
        return Error{"field \"" + name + "\": expected [NUMBER], found \"" + std::string(path) + '"'};
      }
      if (out.type_.arity == Arity::kOne) return Error{"field \"" + name + "\" is one value, not a list"};
      if (out.type_.arity == Arity::kArray && index >= out.type_.length) {
        return Error{"field \"" + name + "\" has " + std::to_string(out.type_.length) + " elements, no [" +
                     std::to_string(index) + ']'};
      }
      name += '[' + std::to_string(index) + ']';
      path.remove_prefix(static_cast<std::size_t>(rest + 1 - path.data()));
      out.type_ = out.type_.element();
      out.steps_.push_back({index, name});
      continue;
    }
    if (!name.empty()) {
      if (path[0] != '.')
        return Error{"field \"" + name + "\": expected . or [, found \"" + std::string(path) + '"'};
      path.remove_prefix(1);
    }
    const std::string field_name(path.substr(0, path.find_first_of(".[")));
    if (out.type_.arity != Arity::kOne) {
      return Error{"field \"" + name + "\" is a list; name an element of it, as in " + name + "[0]"};
    }
    if (out.type_.kind != Kind::kMessage) return Error{"field \"" + name + "\" has no fields of its own"};
    const MessageType& message = schema.message(out.type_);
    const auto field = std::ranges::find(message.fields, field_name, &Field::name);
    if (field == message.fields.end()) {
      return Error{"a " + message.name + " has no field \"" + field_name + "\"; its fields are " +
                   FieldsOf(message)};
    }
    name += (name.empty() ? "" : ".") + field_name;
    path.remove_prefix(field_name.size());
    out.steps_.push_back({static_cast<std::size_t>(field - message.fields.begin()), name});
    out.type_ = field->type;
  }
  return out;
}

Result<Value> FieldPath::In(const Value& message) const {
  const Value* at = &message;
  for (const Step& step : steps_) {
    if (step.index >= at->size()) {
      return Error{step.name + ": the message has only " + std::to_string(at->size()) + " elements there"};
    }
    if (std::holds_alternative<Numbers>(at->content)) return at->At(step.index);  // a number has no parts
    at = &at->values()[step.index];
  }
  return *at;
}

}  // namespace thalweg::inspector
