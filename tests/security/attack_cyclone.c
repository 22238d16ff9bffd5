/* Attacks a run with another vendor's DDS (Eclipse Cyclone), from nothing but idl/: reads every topic of the
 * table, and writes to it lies from files and what it heard. Prints what attack_fast_dds prints.
 *
 *   attack_cyclone DOMAIN SECONDS LIES [--topic NAME]... [--keys DIR ROLE ACCESS]
 *
 *   LIES                     folder that attack_fast_dds --lies has written
 *   --topic NAME             only this topic
 *   --keys DIR ROLE ACCESS   as this role, with its keys, and this library as the plugin for access control
 */
#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "topics_of_table.h"

typedef struct {
  const char* name;
  const char* type_name; /* as ROS 2 registers it */
  const dds_topic_descriptor_t* type;
} TableEntry;

static const TableEntry kTable[] = {THALWEG_TOPICS};
enum { kTopics = sizeof kTable / sizeof kTable[0], kMostLies = 40, kMostHeard = 20, kAtOnce = 32 };

typedef struct {
  const TableEntry* topic;
  dds_topic_descriptor_t renamed; /* kept by Cyclone as long as the topic lives */
  dds_entity_t reader, writer;
  dds_instance_handle_t own;
  const struct ddsi_sertype* type; /* known once a sample was heard, if only its own */
  struct ddsi_serdata* lies[kMostLies];
  struct ddsi_serdata* heard[kMostHeard];
  int lie_count, heard_count, turn, most_readers, most_writers, taken, sent;
} Target;

static Target targets[kTopics];
static volatile sig_atomic_t stopped = 0;

static void Stop(int number) {
  (void)number;
  stopped = 1;
}

static void Fail(const char* what, const char* why) {
  fprintf(stderr, "attack_cyclone: %s: %s\n", what, why);
  exit(EXIT_FAILURE);
}

static void SetFile(dds_qos_t* qos, const char* name, const char* folder, const char* file) {
  char value[4096];
  snprintf(value, sizeof value, "file:%s/%s", folder, file);
  dds_qset_prop(qos, name, value);
}

static dds_qos_t* ParticipantQos(const char* keys, const char* role, const char* access) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_entity_name(qos, "mapper"); /* takes the name of a service */
  if (keys == NULL) return qos;
  char own[2048];
  snprintf(own, sizeof own, "%s/%s", keys, role);
  SetFile(qos, "dds.sec.auth.identity_ca", keys, "ca.pem");
  SetFile(qos, "dds.sec.auth.identity_certificate", own, "certificate.pem");
  SetFile(qos, "dds.sec.auth.private_key", own, "key.pem");
  SetFile(qos, "dds.sec.access.permissions_ca", keys, "ca.pem");
  SetFile(qos, "dds.sec.access.governance", keys, "governance.p7s");
  SetFile(qos, "dds.sec.access.permissions", own, "permissions.p7s");
  dds_qset_prop(qos, "dds.sec.auth.library.path", CYCLONE_SECURITY_AUTH);
  dds_qset_prop(qos, "dds.sec.auth.library.init", "init_authentication");
  dds_qset_prop(qos, "dds.sec.auth.library.finalize", "finalize_authentication");
  dds_qset_prop(qos, "dds.sec.crypto.library.path", CYCLONE_SECURITY_CRYPTO);
  dds_qset_prop(qos, "dds.sec.crypto.library.init", "init_crypto");
  dds_qset_prop(qos, "dds.sec.crypto.library.finalize", "finalize_crypto");
  dds_qset_prop(qos, "dds.sec.access.library.path", access);
  dds_qset_prop(qos, "dds.sec.access.library.init", "init_access_control");
  dds_qset_prop(qos, "dds.sec.access.library.finalize", "finalize_access_control");
  return qos;
}

static void Open(Target* target, dds_entity_t participant) {
  char name[256];
  snprintf(name, sizeof name, "rt/%s", target->topic->name);
  memcpy(&target->renamed, target->topic->type, sizeof target->renamed);
  target->renamed.m_typename = target->topic->type_name;
  const dds_entity_t topic = dds_create_topic(participant, &target->renamed, name, NULL, NULL);
  target->reader = target->writer = topic;
  if (topic < 0) return;
  dds_qos_t* qos = dds_create_qos(); /* takes from whoever writes */
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 100);
  target->reader = dds_create_reader(participant, topic, qos, NULL);
  dds_reset_qos(qos); /* offers what any reader requests */
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 8);
  target->writer = dds_create_writer(participant, topic, qos, NULL);
  dds_delete_qos(qos);
  if (target->writer < 0) return;
  dds_get_instance_handle(target->writer, &target->own);
  void* zeros =
      calloc(1, target->topic->type->m_size); /* a first lie, from which its own reader gets the type */
  if (zeros != NULL && dds_write(target->writer, zeros) == DDS_RETCODE_OK) ++target->sent;
  free(zeros);
}

static void LoadLies(Target* target, const char* folder) {
  for (int k = 0; k < kMostLies; ++k) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%d.%d.cdr", folder, (int)(target->topic - kTable), k);
    FILE* in = fopen(path, "rb");
    if (in == NULL) return;
    fseek(in, 0, SEEK_END);
    const long size = ftell(in);
    rewind(in);
    unsigned char* bytes = calloc(1, (size_t)size + 4);
    if (bytes == NULL || fread(bytes, 1, (size_t)size, in) != (size_t)size) Fail(path, "cannot be read");
    fclose(in);
    const ddsrt_iovec_t piece = {.iov_base = bytes, .iov_len = (size_t)size};
    /* Null where Cyclone itself finds the bytes malformed, such as an enum beyond its values */
    struct ddsi_serdata* lie = ddsi_serdata_from_ser_iov(target->type, SDK_DATA, 1, &piece, (size_t)size);
    if (lie != NULL) target->lies[target->lie_count++] = lie;
    free(bytes);
  }
}

static void Read(Target* target, const char* lies) {
  if (target->reader < 0) return;
  struct ddsi_serdata* samples[kAtOnce] = {NULL};
  dds_sample_info_t infos[kAtOnce];
  const dds_return_t count = dds_takecdr(target->reader, samples, kAtOnce, infos, DDS_ANY_STATE);
  for (int k = 0; k < count; ++k) {
    if (infos[k].valid_data && target->type == NULL) {
      target->type = samples[k]->type;
      LoadLies(target, lies);
    }
    if (infos[k].valid_data && infos[k].publication_handle != target->own) {
      ++target->taken;
      const int slot = target->heard_count < kMostHeard ? target->heard_count++ : rand() % kMostHeard;
      if (target->heard[slot] != NULL) ddsi_serdata_unref(target->heard[slot]);
      target->heard[slot] = ddsi_serdata_ref(samples[k]);
    }
    ddsi_serdata_unref(samples[k]);
  }
}

/* In turn a lie and what was heard. */
static void Write(Target* target) {
  if (target->writer < 0) return;
  struct ddsi_serdata* message = NULL;
  const int turn = target->turn++;
  if (turn % 4 == 3 && target->heard_count > 0) {
    message = target->heard[rand() % target->heard_count];
  } else if (target->lie_count > 0) {
    message = target->lies[turn % target->lie_count];
  }
  if (message == NULL) return;
  if (dds_writecdr(target->writer, ddsi_serdata_ref(message)) == DDS_RETCODE_OK) ++target->sent;
}

static void NoteMatches(Target* target) {
  const int own = target->reader >= 0 && target->writer >= 0 ? 1 : 0; /* it hears itself */
  dds_publication_matched_status_t readers;
  if (target->writer >= 0 && dds_get_publication_matched_status(target->writer, &readers) == DDS_RETCODE_OK) {
    const int others = (int)readers.current_count - own;
    if (others > target->most_readers) target->most_readers = others;
  }
  dds_subscription_matched_status_t writers;
  if (target->reader >= 0 &&
      dds_get_subscription_matched_status(target->reader, &writers) == DDS_RETCODE_OK) {
    const int others = (int)writers.current_count - own;
    if (others > target->most_writers) target->most_writers = others;
  }
}

int main(int argc, char** argv) {
  const char *keys = NULL, *role = NULL, *access = NULL;
  bool chosen[kTopics] = {false}, any = false;
  if (argc < 4)
    Fail("usage", "attack_cyclone DOMAIN SECONDS LIES [--topic NAME]... [--keys DIR ROLE ACCESS]");
  for (int k = 4; k < argc; ++k) {
    if (strcmp(argv[k], "--keys") == 0 && k + 3 < argc) {
      keys = argv[++k];
      role = argv[++k];
      access = argv[++k];
    } else if (strcmp(argv[k], "--topic") == 0 && k + 1 < argc) {
      ++k;
      for (int n = 0; n < kTopics; ++n) {
        if (strcmp(kTable[n].name, argv[k]) == 0) chosen[n] = any = true;
      }
      if (!any) Fail(argv[k], "no such topic");
    } else {
      Fail(argv[k], "unknown, or lacks a value");
    }
  }
  signal(SIGTERM, Stop);
  signal(SIGINT, Stop);
  dds_qos_t* qos = ParticipantQos(keys, role, access);
  const dds_entity_t participant = dds_create_participant((dds_domainid_t)atoi(argv[1]), qos, NULL);
  dds_delete_qos(qos);
  if (participant < 0) Fail("participant", dds_strretcode(-participant));
  int count = 0;
  for (int n = 0; n < kTopics; ++n) {
    if (any && !chosen[n]) continue;
    targets[count].topic = &kTable[n];
    Open(&targets[count++], participant);
  }
  const dds_time_t end = dds_time() + (dds_duration_t)(atof(argv[2]) * 1e9);
  while (!stopped && dds_time() < end) {
    for (int k = 0; k < count; ++k) {
      Read(&targets[k], argv[3]);
      Write(&targets[k]);
      NoteMatches(&targets[k]);
    }
    dds_sleepfor(DDS_MSECS(10));
  }
  for (int k = 0; k < count; ++k) {
    const Target* target = &targets[k];
    const char* refused = target->reader < 0 && target->writer < 0 ? "a reader and a writer"
                          : target->reader < 0                     ? "a reader"
                          : target->writer < 0                     ? "a writer"
                                                                   : "-";
    printf("%s\t%d\t%d\t%d\t%d\t%s\n", target->topic->name, target->most_readers, target->most_writers,
           target->taken, target->sent, refused);
  }
  fflush(stdout);
  _Exit(EXIT_SUCCESS); /* without a leave, as a process that was killed */
}
