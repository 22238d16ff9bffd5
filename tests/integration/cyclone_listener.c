/* Listens to a robot with another vendor's DDS (Eclipse Cyclone), in another language, from nothing but idl/.
 *
 *   cyclone_listener DOMAIN PARTITION COUNT [TIMEOUT_S]
 *
 * Prints one JSON object a line for each message of the topics in kAll, and ends with success when COUNT of
 * each have come, of those that keep their last message for late joiners one, with failure when they have not
 * by TIMEOUT_S. Requests what rviz2 and ROS 2's subscriptions request by default. PARTITION "" is the default
 * one. Long arrays are given by their length, their beginning, and a checksum (FNV-1a).
 */
#include <dds/dds.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "nav_msgs.h"
#include "sensor_msgs.h"
#include "tf2_msgs.h"
#include "thalweg_msgs.h"
#include "visualization_msgs.h"

enum { kTopics = 10, kShown = 4 };

static uint64_t Fnv1a(uint64_t hash, const void* bytes, size_t size) {
  const unsigned char* byte = bytes;
  for (size_t k = 0; k < size; ++k) hash = (hash ^ byte[k]) * UINT64_C(1099511628211);
  return hash;
}
static const uint64_t kFnvStart = UINT64_C(14695981039346656037);

/* JSON knows no NaN. */
static void PrintNumber(const char* name, double value) {
  if (value == value) {
    printf("\"%s\": %.17g, ", name, value);
  } else {
    printf("\"%s\": null, ", name);
  }
}

static void PrintHeader(const char* topic, const std_msgs_msg_Header* header) {
  printf("{\"topic\": \"%s\", \"sec\": %" PRId32 ", \"nanosec\": %" PRIu32 ", \"frame\": \"%s\", ", topic,
         header->stamp.sec, header->stamp.nanosec, header->frame_id);
}

static void PrintPose(const char* name, const geometry_msgs_msg_Pose* pose, const char* end) {
  printf("\"%s\": [%.17g, %.17g, %.17g, %.17g, %.17g, %.17g, %.17g]%s", name, pose->position.x,
         pose->position.y, pose->position.z, pose->orientation.x, pose->orientation.y, pose->orientation.z,
         pose->orientation.w, end);
}

static void PrintPoints(const char* topic, const sensor_msgs_msg_PointCloud2* cloud) {
  PrintHeader(topic, &cloud->header);
  printf("\"height\": %" PRIu32 ", \"width\": %" PRIu32 ", \"fields\": [", cloud->height, cloud->width);
  for (uint32_t k = 0; k < cloud->fields._length; ++k) {
    const sensor_msgs_msg_PointField* field = &cloud->fields._buffer[k];
    printf("%s[\"%s\", %" PRIu32 ", %u, %" PRIu32 "]", k == 0 ? "" : ", ", field->name, field->offset,
           (unsigned)field->datatype, field->count);
  }
  printf("], \"is_bigendian\": %d, \"point_step\": %" PRIu32 ", \"row_step\": %" PRIu32
         ", \"is_dense\": %d, ",
         cloud->is_bigendian, cloud->point_step, cloud->row_step, cloud->is_dense);
  printf("\"bytes\": %" PRIu32 ", \"fnv1a\": %" PRIu64 "}\n", cloud->data._length,
         Fnv1a(kFnvStart, cloud->data._buffer, cloud->data._length));
}

static void PrintCloud(const void* message) {
  PrintPoints("depth/points", message);
}
static void PrintOccupied(const void* message) {
  PrintPoints("map/occupied", message);
}

static void PrintImage(const char* topic, const void* message) {
  const sensor_msgs_msg_Image* image = message;
  PrintHeader(topic, &image->header);
  printf("\"height\": %" PRIu32 ", \"width\": %" PRIu32 ", \"encoding\": \"%s\", \"is_bigendian\": %u, ",
         image->height, image->width, image->encoding, (unsigned)image->is_bigendian);
  printf("\"step\": %" PRIu32 ", \"bytes\": %" PRIu32 ", \"fnv1a\": %" PRIu64 "}\n", image->step,
         image->data._length, Fnv1a(kFnvStart, image->data._buffer, image->data._length));
}
static void PrintLeft(const void* message) {
  PrintImage("stereo/left/image_raw", message);
}
static void PrintDepth(const void* message) {
  PrintImage("depth/image", message);
}

static void PrintCamera(const void* message) {
  const sensor_msgs_msg_CameraInfo* info = message;
  PrintHeader("stereo/left/camera_info", &info->header);
  printf("\"height\": %" PRIu32 ", \"width\": %" PRIu32 ", \"model\": \"%s\", \"d\": %" PRIu32 ", \"p\": [",
         info->height, info->width, info->distortion_model, info->d._length);
  for (int k = 0; k < 12; ++k) printf("%s%.17g", k == 0 ? "" : ", ", info->p[k]);
  printf("]}\n");
}

static void PrintTransforms(const void* message) {
  const tf2_msgs_msg_TFMessage* tf = message;
  printf("{\"topic\": \"tf_static\", \"transforms\": [");
  for (uint32_t k = 0; k < tf->transforms._length; ++k) {
    const geometry_msgs_msg_TransformStamped* transform = &tf->transforms._buffer[k];
    printf("%s[\"%s\", \"%s\"]", k == 0 ? "" : ", ", transform->header.frame_id, transform->child_frame_id);
  }
  printf("]}\n");
}

static void PrintMarkers(const void* message) {
  const visualization_msgs_msg_MarkerArray* array = message;
  printf("{\"topic\": \"explorer/frontier_markers\", \"markers\": [");
  for (uint32_t k = 0; k < array->markers._length; ++k) {
    const visualization_msgs_msg_Marker* marker = &array->markers._buffer[k];
    printf("%s{\"frame\": \"%s\", \"ns\": \"%s\", \"id\": %" PRId32 ", \"text\": \"%s\", ",
           k == 0 ? "" : ", ", marker->header.frame_id, marker->ns, marker->id, marker->text);
    PrintPose("pose", &marker->pose, "}");
  }
  printf("]}\n");
}

static void PrintOdometry(const void* message) {
  const nav_msgs_msg_Odometry* odometry = message;
  PrintHeader("odometry", &odometry->header);
  printf("\"child\": \"%s\", ", odometry->child_frame_id);
  PrintPose("pose", &odometry->pose.pose, ", ");
  const geometry_msgs_msg_Twist* twist = &odometry->twist.twist;
  printf("\"twist\": [%.17g, %.17g, %.17g, %.17g, %.17g, %.17g]}\n", twist->linear.x, twist->linear.y,
         twist->linear.z, twist->angular.x, twist->angular.y, twist->angular.z);
}

static void PrintPath(const void* message) {
  const nav_msgs_msg_Path* path = message;
  PrintHeader("explorer/path", &path->header);
  printf("\"poses\": [");
  for (uint32_t k = 0; k < path->poses._length; ++k) {
    const geometry_msgs_msg_PoseStamped* pose = &path->poses._buffer[k];
    printf("%s{\"frame\": \"%s\", ", k == 0 ? "" : ", ", pose->header.frame_id);
    PrintPose("pose", &pose->pose, "}");
  }
  printf("]}\n");
}

static void PrintUpdate(const void* message) {
  const thalweg_msgs_msg_MapUpdate* update = message;
  PrintHeader("map/updates", &update->header);
  printf("\"session\": %" PRIu64 ", \"number\": %" PRIu64 ", \"full\": %d, ", update->session, update->number,
         update->full);
  PrintNumber("voxel_size_m", update->voxel_size_m);
  printf("\"scans\": [");
  for (uint32_t k = 0; k < update->scans._length; ++k) {
    const thalweg_msgs_msg_ScanView* scan = &update->scans._buffer[k];
    printf("%s{\"sec\": %" PRId32 ", ", k == 0 ? "" : ", ", scan->stamp.sec);
    PrintPose("pose", &scan->map_from_camera, ", ");
    printf("\"measured\": %" PRIu32 ", \"fnv1a\": %" PRIu64 "}", scan->measured._length,
           Fnv1a(kFnvStart, scan->measured._buffer, scan->measured._length));
  }
  printf("], \"blocks\": %" PRIu32 ", \"first_blocks\": [", update->blocks._length);
  uint64_t hash = kFnvStart;
  for (uint32_t k = 0; k < update->blocks._length; ++k) {
    const thalweg_msgs_msg_MapBlock* block = &update->blocks._buffer[k];
    hash = Fnv1a(hash, block->mask, sizeof block->mask);
    hash = Fnv1a(hash, block->log_odds._buffer, block->log_odds._length * sizeof(float));
    if (k >= kShown) continue;
    printf("%s{\"index\": [%" PRId32 ", %" PRId32 ", %" PRId32 "], \"voxels\": %" PRIu32 "}",
           k == 0 ? "" : ", ", block->x, block->y, block->z, block->log_odds._length);
  }
  printf("], \"fnv1a\": %" PRIu64 "}\n", hash);
}

typedef struct {
  const char* name;
  const char* type_name; /* as ROS 2 registers it; idlc would say sensor_msgs::msg::PointCloud2 */
  const dds_topic_descriptor_t* type;
  void (*print)(const void*);
  bool latched; /* reliable and transient local, the last one, as tf2 requests tf_static */
} Topic;

static const Topic kAll[kTopics] = {
    {"rt/depth/points", "sensor_msgs::msg::dds_::PointCloud2_", &sensor_msgs_msg_PointCloud2_desc, PrintCloud,
     false},
    {"rt/stereo/left/image_raw", "sensor_msgs::msg::dds_::Image_", &sensor_msgs_msg_Image_desc, PrintLeft,
     false},
    {"rt/stereo/left/camera_info", "sensor_msgs::msg::dds_::CameraInfo_", &sensor_msgs_msg_CameraInfo_desc,
     PrintCamera, false},
    {"rt/depth/image", "sensor_msgs::msg::dds_::Image_", &sensor_msgs_msg_Image_desc, PrintDepth, false},
    {"rt/odometry", "nav_msgs::msg::dds_::Odometry_", &nav_msgs_msg_Odometry_desc, PrintOdometry, false},
    {"rt/explorer/path", "nav_msgs::msg::dds_::Path_", &nav_msgs_msg_Path_desc, PrintPath, false},
    {"rt/map/updates", "thalweg_msgs::msg::dds_::MapUpdate_", &thalweg_msgs_msg_MapUpdate_desc, PrintUpdate,
     false},
    {"rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_", &tf2_msgs_msg_TFMessage_desc, PrintTransforms, true},
    {"rt/map/occupied", "sensor_msgs::msg::dds_::PointCloud2_", &sensor_msgs_msg_PointCloud2_desc,
     PrintOccupied, true},
    {"rt/explorer/frontier_markers", "visualization_msgs::msg::dds_::MarkerArray_",
     &visualization_msgs_msg_MarkerArray_desc, PrintMarkers, true},
};

static dds_entity_t MustExist(dds_entity_t entity, const char* what) {
  if (entity >= 0) return entity;
  fprintf(stderr, "cyclone_listener: %s: %s\n", what, dds_strretcode(-entity));
  exit(EXIT_FAILURE);
}

/* `renamed` is kept by Cyclone as long as the topic lives. */
static dds_entity_t MakeReader(dds_entity_t participant, dds_entity_t subscriber, const Topic* topic,
                               dds_topic_descriptor_t* renamed) {
  memcpy(renamed, topic->type, sizeof *renamed);
  renamed->m_typename = topic->type_name;

  dds_qos_t* qos = dds_create_qos();
  /* What a subscription of ROS 2 requests by default (rmw_qos_profile_default) */
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_durability(qos, topic->latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, topic->latched ? 1 : 10);
  const dds_entity_t dds_topic =
      MustExist(dds_create_topic(participant, renamed, topic->name, NULL, NULL), topic->name);
  const dds_entity_t reader = MustExist(dds_create_reader(subscriber, dds_topic, qos, NULL), topic->name);
  dds_delete_qos(qos);
  return reader;
}

static int TakeAll(dds_entity_t reader, const Topic* topic) {
  int taken = 0;
  for (;;) {
    void* sample = NULL; /* lent by Cyclone */
    dds_sample_info_t info;
    if (dds_take(reader, &sample, &info, 1, 1) <= 0) return taken;
    if (info.valid_data) {
      topic->print(sample);
      ++taken;
    }
    dds_return_loan(reader, &sample, 1);
  }
}

int main(int argc, char** argv) {
  if (argc < 4) {
    fprintf(stderr, "usage: cyclone_listener DOMAIN PARTITION COUNT [TIMEOUT_S]\n");
    return EXIT_FAILURE;
  }
  const int count = atoi(argv[3]);
  const dds_time_t deadline = dds_time() + DDS_SECS(argc > 4 ? atoi(argv[4]) : 30);
  const dds_entity_t participant =
      MustExist(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  dds_qos_t* qos = dds_create_qos();
  if (argv[2][0] != '\0') dds_qset_partition1(qos, argv[2]);
  const dds_entity_t subscriber = MustExist(dds_create_subscriber(participant, qos, NULL), "subscriber");
  dds_delete_qos(qos);

  const dds_entity_t wait_set = MustExist(dds_create_waitset(participant), "wait-set");
  dds_entity_t readers[kTopics];
  dds_topic_descriptor_t types[kTopics];
  int come[kTopics] = {0};
  for (int k = 0; k < kTopics; ++k) {
    readers[k] = MakeReader(participant, subscriber, &kAll[k], &types[k]);
    dds_set_status_mask(readers[k], DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(wait_set, readers[k], (dds_attach_t)k);
  }
  bool done = false;
  while (!done && dds_time() < deadline) {
    dds_waitset_wait_until(wait_set, NULL, 0, deadline);
    done = true;
    for (int k = 0; k < kTopics; ++k) {
      come[k] += TakeAll(readers[k], &kAll[k]);
      done = done && come[k] >= (kAll[k].latched ? 1 : count);
    }
    fflush(stdout);
  }
  for (int k = 0; k < kTopics; ++k) fprintf(stderr, "%s: %d\n", kAll[k].name, come[k]);
  dds_delete(participant);
  return done ? EXIT_SUCCESS : EXIT_FAILURE;
}
