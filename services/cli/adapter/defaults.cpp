#include "services/cli/adapter/defaults.h"

#include <google/protobuf/text_format.h>

#include <sstream>

#include "common/scenario/option_binding.h"
#include "common/service/shared_options.h"
#include "services/controller/adapter/options.h"
#include "services/explorer/adapter/options.h"
#include "services/link/adapter/options.h"
#include "services/mapper/adapter/options.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/adapter/options.h"
#include "services/simulator/adapter/stereo_camera.h"
#include "services/stereo/adapter/options.h"
#include "services/surface/adapter/options.h"
#include "services/visual_odometry/adapter/options.h"

namespace thalweg::cli {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

/// Whether there is a stereo camera, as an option of its own.
struct StereoSwitch {
  bool enabled;
};
void Visit(OptionVisitor& visitor, StereoSwitch& camera) {
  visitor.Switch("enabled", camera.enabled);
}

/// @param given  The same message as given; null if it was not.
void Print(const Message& full, const Message* given, const std::string& indent, std::ostream& out) {
  const Reflection& reflection = *full.GetReflection();
  for (int k = 0; k < full.GetDescriptor()->field_count(); ++k) {
    const FieldDescriptor* const field = full.GetDescriptor()->field(k);
    if (field->is_repeated()) {  // messages, which have no default
      for (int n = 0; n < reflection.FieldSize(full, field); ++n) {
        const Message& inner = reflection.GetRepeatedMessage(full, field, n);
        out << indent << field->name() << " {\n";
        Print(inner, &inner, indent + "  ", out);
        out << indent << "}\n";
      }
      continue;
    }
    const bool always = !field->has_presence();  // a vector's component 0
    if (!always && !reflection.HasField(full, field)) continue;
    const bool is_given = given != nullptr && (always || reflection.HasField(*given, field));
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      const bool vector = field->message_type() == Vector3::descriptor();
      out << indent << field->name() << (vector && !is_given ? " {  # default\n" : " {\n");
      const Message& inner = reflection.GetMessage(full, field);
      const Message* const its_given = is_given ? &reflection.GetMessage(*given, field) : nullptr;
      Print(inner, vector ? &inner : its_given, indent + "  ", out);
      out << indent << "}\n";
      continue;
    }
    std::string value;
    google::protobuf::TextFormat::PrintFieldValueToString(full, field, -1, &value);
    out << indent << field->name() << ": " << value << (is_given ? "\n" : "  # default\n");
  }
}

}  // namespace

void VisitScenario(OptionVisitor& visitor, const Scenario& given) {
  VisitShared(visitor, given);
  const auto block = [&](const char* field, auto... options) {
    visitor.Block(field, [&](OptionVisitor& inner) { (Visit(inner, options), ...); });
  };
  block("stereo_camera", StereoSwitch{given.stereo_camera().enabled()}, simulator::StereoRigFrom(given));
  block("world", simulator::WorldOptions());
  block("simulator", simulator::StartOptions(), simulator::SimulatorOptions());
  block("mapper", mapper::OptionsFrom(given, {}));
  block("explorer", explorer::OptionsFrom(given));
  block("controller", controller::ControllerOptions());
  block("surface", surface::SurfaceServiceOptions());
  block("stereo", stereo::StereoOptions());
  block("link", link::LinkOptions());
  block("visual_odometry", visual_odometry::VisualOdometryOptions());
}

Scenario WithDefaults(const Scenario& given) {
  Scenario full = given;
  OptionWriter writer(full);
  VisitScenario(writer, given);
  return full;
}

std::string CommentedText(const Scenario& full, const Scenario& given) {
  std::ostringstream out;
  Print(full, &given, "", out);
  return out.str();
}

}  // namespace thalweg::cli
