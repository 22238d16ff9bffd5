#include "common/service/shared_options.h"

#include <string>

#include "common/scenario/models.h"
#include "common/scenario/option_binding.h"
#include "common/service/service.h"

namespace thalweg {

void VisitShared(OptionVisitor& visitor, const Scenario& given) {
  std::string depth_source = DepthSource::Kind_Name(given.depth_source());
  std::string odometry_source = OdometrySource::Kind_Name(given.odometry_source());
  visitor.Text("depth_source", depth_source);
  visitor.Text("odometry_source", odometry_source);
  const auto block = [&](const char* field, auto... options) {
    visitor.Block(field, [&](OptionVisitor& inner) { (Visit(inner, options), ...); });
  };
  block("network", NetworkFrom(given));
  block("robot", RobotFrom(given), RobotName{});
  block("topics", dds::TopicNames());
  block("frames", dds::FrameNames());
  block("depth_sensor", DepthSensorFrom(given));
  block("mapper", MapFrom(given), DepthErrorFrom(given));
}

Scenario WithSharedDefaults(const Scenario& given) {
  Scenario full = given;
  OptionWriter writer(full);
  VisitShared(writer, given);
  return full;
}

}  // namespace thalweg
