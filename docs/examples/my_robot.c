/* A robot for thalweg in C, complete, with Eclipse Cyclone DDS and nothing of thalweg but its idl/.
 *
 *   my_robot [DOMAIN]
 *
 * It publishes its odometry and what its depth camera sees, and moves where command/pose says. Replace the
 * corridor by your camera and the jump to the commanded pose by your motors (docs/guide/own-robot.md). */
#include <dds/dds.h>
#include <stdlib.h>

#include "corridor.h"
#include "nav_msgs.h"
#include "sensor_msgs.h"

enum { kWidth = 120, kHeight = 90, kPoints = kWidth * kHeight };
static const double kFocalPx = 72.0; /* so that the image is 80 degrees wide */

/* What the camera sees: a point for each pixel, in camera_optical_frame: x right, y down, z forward. */
static void LookAround(const geometry_msgs_msg_Pose* body, float points[kPoints][3]) {
  const double p[3] = {body->position.x, body->position.y, body->position.z};
  const double q[4] = {body->orientation.x, body->orientation.y, body->orientation.z, body->orientation.w};
  for (int k = 0; k < kPoints; ++k) {
    const double right = (k % kWidth - (kWidth - 1) / 2.0) / kFocalPx;
    const double down = (k / kWidth - (kHeight - 1) / 2.0) / kFocalPx;
    const double depth = CorridorDepth(p, q, right, down); /* NaN where a camera measured nothing */
    points[k][0] = (float)(depth * right);
    points[k][1] = (float)(depth * down);
    points[k][2] = (float)depth;
  }
}

/* A DDS topic as ROS 2 names it. */
static dds_entity_t Topic(dds_entity_t node, const char* name, const char* type_name,
                          dds_topic_descriptor_t type) {
  type.m_typename = type_name;
  return dds_create_topic(node, &type, name, NULL, NULL);
}

int main(int argc, char** argv) {
  const dds_entity_t node = dds_create_participant(argc > 1 ? (dds_domainid_t)atoi(argv[1]) : 0, NULL, NULL);
  if (node < 0) return EXIT_FAILURE;
  const dds_entity_t odometry_topic =
      Topic(node, "rt/odometry", "nav_msgs::msg::dds_::Odometry_", nav_msgs_msg_Odometry_desc);
  const dds_entity_t points_topic = Topic(node, "rt/depth/points", "sensor_msgs::msg::dds_::PointCloud2_",
                                          sensor_msgs_msg_PointCloud2_desc);
  const dds_entity_t command_topic = Topic(node, "rt/command/pose", "geometry_msgs::msg::dds_::PoseStamped_",
                                           geometry_msgs_msg_PoseStamped_desc);
  const dds_entity_t odometry_out = dds_create_writer(node, odometry_topic, NULL, NULL);
  const dds_entity_t points_out = dds_create_writer(node, points_topic, NULL, NULL);
  const dds_entity_t command_in = dds_create_reader(node, command_topic, NULL, NULL);

  static float points[kPoints][3];
  sensor_msgs_msg_PointField xyz[3] = {{"x", 0, 7, 1}, {"y", 4, 7, 1}, {"z", 8, 7, 1}}; /* 7 = float32 */
  nav_msgs_msg_Odometry odometry = {
      .header.frame_id = "odom", .child_frame_id = "base_link", .pose.pose.orientation.w = 1.0};
  sensor_msgs_msg_PointCloud2 cloud = {.header.frame_id = "camera_optical_frame",
                                       .height = kHeight,
                                       .width = kWidth,
                                       .fields = {._length = 3, ._buffer = xyz},
                                       .point_step = sizeof points[0],
                                       .row_step = sizeof points[0] * kWidth,
                                       .data = {._length = sizeof points, ._buffer = (uint8_t*)points},
                                       .is_dense = true};
  for (int tick = 0;; ++tick) {
    void* sample = NULL; /* the newest command; without one the robot stays where it is */
    dds_sample_info_t info;
    if (dds_take(command_in, &sample, &info, 1, 1) > 0) {
      if (info.valid_data) odometry.pose.pose = ((geometry_msgs_msg_PoseStamped*)sample)->pose;
      dds_return_loan(command_in, &sample, 1);
    }
    const dds_time_t now = dds_time(); /* the machine's wall clock, for both */
    odometry.header.stamp.sec = cloud.header.stamp.sec = (int32_t)(now / DDS_NSECS_IN_SEC);
    odometry.header.stamp.nanosec = cloud.header.stamp.nanosec = (uint32_t)(now % DDS_NSECS_IN_SEC);
    dds_write(odometry_out, &odometry); /* 50 times a second */
    if (tick % 10 == 0) {               /* 5 times a second */
      LookAround(&odometry.pose.pose, points);
      dds_write(points_out, &cloud);
    }
    dds_sleepfor(DDS_MSECS(20));
  }
}
