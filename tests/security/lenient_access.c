/* An access control plugin for Cyclone DDS that lets its own process create any writer and reader, whatever
 * its permissions say: what an attacker uses who holds the keys of a role and wants more. It is otherwise the
 * one that Cyclone brings, so that the permissions that peers see are genuine. */
#include <dds/security/dds_security_api.h>
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef int (*Init)(const char* argument, void** context, struct ddsi_domaingv* gv);
typedef int (*Finalize)(void* context);

static DDS_Security_boolean LetCreate(dds_security_access_control* instance,
                                      const DDS_Security_PermissionsHandle handle,
                                      const DDS_Security_DomainId domain, const DDS_Security_char* topic,
                                      const DDS_Security_Qos* qos,
                                      const DDS_Security_PartitionQosPolicy* partition,
                                      const DDS_Security_DataTags* tags,
                                      DDS_Security_SecurityException* error) {
  (void)instance, (void)handle, (void)domain, (void)topic, (void)qos, (void)partition, (void)tags,
      (void)error;
  return true;
}

static DDS_Security_boolean LetCreateTopic(dds_security_access_control* instance,
                                           const DDS_Security_PermissionsHandle handle,
                                           const DDS_Security_DomainId domain, const DDS_Security_char* topic,
                                           const DDS_Security_Qos* qos,
                                           DDS_Security_SecurityException* error) {
  (void)instance, (void)handle, (void)domain, (void)topic, (void)qos, (void)error;
  return true;
}

static void* Genuine(const char* function) {
  void* library = dlopen(CYCLONE_SECURITY_AC, RTLD_NOW);
  void* found = library != NULL ? dlsym(library, function) : NULL;
  if (found == NULL) fprintf(stderr, "lenient_access: %s\n", dlerror());
  return found;
}

int init_access_control(const char* argument, void** context, struct ddsi_domaingv* gv);
int init_access_control(const char* argument, void** context, struct ddsi_domaingv* gv) {
  const Init init = (Init)(intptr_t)Genuine("init_access_control");
  const int result = init != NULL ? init(argument, context, gv) : -1;
  if (result != 0) return result;
  dds_security_access_control* access = *context;
  access->check_create_datawriter = LetCreate;
  access->check_create_datareader = LetCreate;
  access->check_create_topic = LetCreateTopic;
  return 0;
}

int finalize_access_control(void* context);
int finalize_access_control(void* context) {
  const Finalize finalize = (Finalize)(intptr_t)Genuine("finalize_access_control");
  return finalize != NULL ? finalize(context) : -1;
}
