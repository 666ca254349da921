// DDS Security's access control plug-in as an intruder would patch it: its own side permits everything, so that nothing
// but the robot is left to refuse. The permissions that it shows to others are the real ones. Loaded by Cyclone DDS.
// C, because the interface's headers are not C++.
#include <dds/security/dds_security_api.h>
#include <dlfcn.h>
#include <stdio.h>

typedef dds_security_access_control Control;
typedef DDS_Security_PermissionsHandle Permissions;
typedef DDS_Security_DomainId Domain;
typedef DDS_Security_SecurityException Failure;
typedef int (*Init)(const char*, void**, struct ddsi_domaingv*);
typedef int (*Finalize)(void*);

#define UNUSED(a) ((void)(a))

static DDS_Security_boolean CreateParticipant(Control* c, Permissions p, Domain d, const DDS_Security_Qos* q, Failure* f) {
  UNUSED(c), UNUSED(p), UNUSED(d), UNUSED(q), UNUSED(f);
  return 1;
}

static DDS_Security_boolean CreateEndpoint(Control* c, Permissions p, Domain d, const DDS_Security_char* topic,
                                           const DDS_Security_Qos* q, const DDS_Security_PartitionQosPolicy* partition,
                                           const DDS_Security_DataTags* tags, Failure* f) {
  UNUSED(c), UNUSED(p), UNUSED(d), UNUSED(topic), UNUSED(q), UNUSED(partition), UNUSED(tags), UNUSED(f);
  return 1;
}

static DDS_Security_boolean CreateTopic(Control* c, Permissions p, Domain d, const DDS_Security_char* topic,
                                        const DDS_Security_Qos* q, Failure* f) {
  UNUSED(c), UNUSED(p), UNUSED(d), UNUSED(topic), UNUSED(q), UNUSED(f);
  return 1;
}

static DDS_Security_boolean RemoteParticipant(Control* c, Permissions p, Domain d,
                                              const DDS_Security_ParticipantBuiltinTopicDataSecure* data, Failure* f) {
  UNUSED(c), UNUSED(p), UNUSED(d), UNUSED(data), UNUSED(f);
  return 1;
}

static DDS_Security_boolean RemoteWriter(Control* c, Permissions p, Domain d,
                                         const DDS_Security_PublicationBuiltinTopicDataSecure* data, Failure* f) {
  UNUSED(c), UNUSED(p), UNUSED(d), UNUSED(data), UNUSED(f);
  return 1;
}

static DDS_Security_boolean RemoteReader(Control* c, Permissions p, Domain d,
                                         const DDS_Security_SubscriptionBuiltinTopicDataSecure* data,
                                         DDS_Security_boolean* relay_only, Failure* f) {
  UNUSED(c), UNUSED(p), UNUSED(d), UNUSED(data), UNUSED(f);
  *relay_only = 0;
  return 1;
}

// A function of Cyclone's own plug-in, which Debian keeps in a folder of its own.
static void* Real(const char* function) {
  void* plugin = dlopen(WIREPOSE_DDS_LIBRARIES "/libddsc0debian/libdds_security_ac.so", RTLD_NOW);
  if (plugin == NULL) plugin = dlopen("libdds_security_ac.so", RTLD_NOW);
  if (plugin == NULL) fprintf(stderr, "lax_access_control: %s\n", dlerror());
  return plugin == NULL ? NULL : dlsym(plugin, function);
}

int init_access_control(const char* argument, void** context, struct ddsi_domaingv* gv) {
  const Init init = (Init)Real("init_access_control");
  if (init == NULL || init(argument, context, gv) != 0) return -1;
  Control* const control = *context;
  control->check_create_participant = CreateParticipant;
  control->check_create_datawriter = CreateEndpoint;
  control->check_create_datareader = CreateEndpoint;
  control->check_create_topic = CreateTopic;
  control->check_remote_participant = RemoteParticipant;
  control->check_remote_datawriter = RemoteWriter;
  control->check_remote_datareader = RemoteReader;
  fputs("lax_access_control: permits everything\n", stderr);
  return 0;
}

int finalize_access_control(void* context) {
  const Finalize finalize = (Finalize)Real("finalize_access_control");
  return finalize == NULL ? -1 : finalize(context);
}
