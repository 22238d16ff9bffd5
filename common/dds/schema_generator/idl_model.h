#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace thalweg::idl {

/// The types of IDL files, as ROS 2 message definitions.
///
/// Understands the part of IDL 4.2 that idl/ uses: two modules (PACKAGE and msg), struct, enum, sequence,
/// arrays of one dimension, string and the numbers. Comments are kept: those on the lines above a
/// declaration, and the one behind it with the lines that continue it in the same column.
class IdlModel {
 public:
  /// Adds a file's types. Includes are skipped: their files are to be added as well, in any order.
  /// Throws std::runtime_error "FILE:LINE: ..." for what it does not understand.
  void Add(const std::string& file, std::string_view text);

  /// The structs of all files, as "PACKAGE/msg/NAME", in alphabetical order.
  std::vector<std::string> Structs() const;

  /// The struct's definition, followed by those of all structs it contains, each once, separated as the
  /// schema encoding "ros2msg" prescribes. An enum becomes constants and a uint32, which is how CDR encodes
  /// it. Throws std::runtime_error if it refers to a type that no file defines.
  std::string Ros2Msg(const std::string& name) const;

  /// The struct's description whose SHA-256 is its type hash [REP 2016, "RIHS01"], as JSON. Empty if it or a
  /// struct it contains has an enum, which ROS 2 does not know. Throws as Ros2Msg does.
  std::string Description(const std::string& name) const;

 private:
  struct Field {
    std::string type;    ///< As ROS 2 writes it, or the name of a type of ours, "PACKAGE/msg/NAME".
    std::string suffix;  ///< "", "[]" or "[9]".
    std::string name;
    std::vector<std::string> above;  ///< Lines of comment.
    std::string behind;
    std::string place;  ///< FILE:LINE
  };
  struct Value {
    std::string name;
    std::string behind;
  };
  struct Struct {
    std::vector<std::string> above;
    std::vector<Field> fields;
  };
  class Parser;

  /// Adds the structs that a struct contains, directly and indirectly. Returns whether it contains an enum.
  bool AddContained(const std::string& name, std::set<std::string>& contained) const;
  std::string DescriptionAlone(const std::string& name) const;
  void AppendDefinition(const std::string& name, std::string& out, std::vector<std::string>& needed) const;

  std::map<std::string, Struct> structs_;
  std::map<std::string, std::vector<Value>> enums_;
};

}  // namespace thalweg::idl
