/* A robot for thalweg in C, complete, with Eclipse Cyclone DDS and nothing of thalweg but its idl/.
 *
 *   my_robot [DOMAIN]
 *
 * It stands in a corridor with a crate, publishes its odometry and what its depth camera sees, and moves
 * where command/pose says. Replace the corridor by your camera and the jump to the commanded pose by your
 * motors. docs/guide/own-robot.md says how to build and run it. */
#include <dds/dds.h>
#include <math.h>
#include <stdlib.h>

#include "nav_msgs.h"
#include "sensor_msgs.h"

enum { kWidth = 120, kHeight = 90, kPoints = kWidth * kHeight };
static const double kFocalPx = 72.0; /* so that the image is 80 degrees wide */

typedef struct {
  double min[3], max[3]; /* [m] in map */
} Box;
static const Box kCorridor = {{-1.0, -0.8, -0.9}, {4.0, 0.8, 0.9}};
static const Box kCrate = {{1.5, -0.8, -0.9}, {2.0, -0.1, 0.2}};

/* A ray from p in direction d is inside the box between t[0] and t[1], if t[0] < t[1]. */
static void Cross(const Box* box, const double p[3], const double d[3], double t[2]) {
  t[0] = -INFINITY;
  t[1] = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const double a = (box->min[k] - p[k]) / d[k], b = (box->max[k] - p[k]) / d[k];
    t[0] = fmax(t[0], fmin(a, b));
    t[1] = fmin(t[1], fmax(a, b));
  }
}

/* Turns d from base_link to map. */
static void Turn(const geometry_msgs_msg_Quaternion* q, double d[3]) {
  const double t[3] = {2 * (q->y * d[2] - q->z * d[1]), 2 * (q->z * d[0] - q->x * d[2]),
                       2 * (q->x * d[1] - q->y * d[0])};
  d[0] += q->w * t[0] + q->y * t[2] - q->z * t[1];
  d[1] += q->w * t[1] + q->z * t[0] - q->x * t[2];
  d[2] += q->w * t[2] + q->x * t[1] - q->y * t[0];
}

/* What the camera sees: a point for each pixel, in camera_optical_frame: x right, y down, z forward. */
static void LookAround(const geometry_msgs_msg_Pose* body, float points[kPoints][3]) {
  const double p[3] = {body->position.x, body->position.y, body->position.z};
  for (int k = 0; k < kPoints; ++k) {
    const double right = (k % kWidth - (kWidth - 1) / 2.0) / kFocalPx;
    const double down = (k / kWidth - (kHeight - 1) / 2.0) / kFocalPx;
    double d[3] = {1.0, -right, -down}, wall[2], crate[2]; /* the camera looks along the body's x */
    Turn(&body->orientation, d);
    Cross(&kCorridor, p, d, wall);
    Cross(&kCrate, p, d, crate);
    const double depth = crate[0] < crate[1] && crate[0] > 0 ? crate[0] : wall[1];
    points[k][0] = (float)(depth * right);
    points[k][1] = (float)(depth * down);
    points[k][2] = (float)depth; /* all three NaN where a camera measured nothing */
  }
}

/* A DDS topic as ROS 2 names it, e.g. depth/points of sensor_msgs::msg::dds_::PointCloud2_. */
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
