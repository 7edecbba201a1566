//===- RclGraph.cpp -------------------------------------------------------===//
#include "ros2/RclGraph.h"
#include "HostCalls.h"
#include "RclState.h"
#include "ros2/Arguments.h"
#include "ros2/Rcl.h"

#include <rcl/init.h>
#include <rcl/init_options.h>
#include <rcl/node_options.h>

#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fstream>
#include <pthread.h>

namespace tpc {

RclGraph &RclGraph::of() {
  // Never destroyed: threads may report until the very end.
  static auto &Only = *new RclGraph;
  return Only;
}

RclGraph::RclGraph() {
  pthread_atfork(nullptr, nullptr, [] {
    if (of().Up || *of().name())
      of().Forked = true;
  });
}

const char *RclGraph::name() const {
  if (const char *Name = host().rcl().Node)
    return Name;
  const char *Name = OwnName;
  return Name ? Name : "";
}

void RclGraph::setName(const std::string &Name) {
  OwnName = strdup(Name.c_str());
}

/// The major version of the rcl of this process; 0 if that is not known.
static int versionOfRcl() {
  Dl_info Info;
  if (!dladdr(reinterpret_cast<void *>(&rcl_init), &Info) || !Info.dli_fname)
    return 0;
  const std::string Path = Info.dli_fname;
  std::ifstream File(Path.substr(0, Path.rfind('/') + 1) +
                     "../share/rcl/package.xml");
  const std::string Tag = "<version>";
  for (std::string Line; std::getline(File, Line);)
    if (const size_t At = Line.find(Tag); At != std::string::npos)
      return std::atoi(Line.c_str() + At + Tag.size());
  return 0;
}

std::string RclGraph::mismatch() {
  const int Version = versionOfRcl();
  if (!Version || Version == TPC_RCL_VERSION)
    return "";
  return "libtpc_log_ros2.so was built for rcl " +
         std::to_string(TPC_RCL_VERSION) + ", and this is rcl " +
         std::to_string(Version);
}

bool RclGraph::begin(const std::string &Name, std::string &Why) {
  rcl_init_options_t Options = rcl_get_zero_initialized_init_options();
  bool IsMade = false;
  if (rcl_init_options_init(&Options, rcl_get_default_allocator()) ==
      RCL_RET_OK) {
    // The program may have chosen another one than the environment has.
    if (const int64_t Domain = host().rcl().Domain; Domain >= 0)
      isOk(rcl_init_options_set_domain_id(&Options,
                                          static_cast<size_t>(Domain)));
    Context = rcl_get_zero_initialized_context();
    // The others of the command line would rename the node.
    const std::string Enclave = enclaveOfCommandLine();
    const char *Words[] = {"", "--ros-args", "--enclave", Enclave.c_str()};
    IsMade =
        rcl_init(Enclave.empty() ? 0 : 4, Enclave.empty() ? nullptr : Words,
                 &Options, &Context) == RCL_RET_OK;
    if (!IsMade)
      Why = reasonOfRcl();
    isOk(rcl_init_options_fini(&Options));
  }
  if (!IsMade)
    return false;
  rcl_node_options_t Of = rcl_node_get_default_options();
  Of.enable_rosout = false;
  Node = rcl_get_zero_initialized_node();
  if (rcl_node_init(&Node, "_tpc", Name.c_str(), &Context, &Of) != RCL_RET_OK) {
    Why = reasonOfRcl();
    isOk(rcl_shutdown(&Context));
    isOk(rcl_context_fini(&Context));
    return false;
  }
  Up = true;
  // Registered now, it runs before the destructors of what exists by now:
  // handlers run in the opposite order.
  static const int Registered = std::atexit([] { host().endRuntime(); });
  return Registered == 0;
}

void RclGraph::end() {
  if (!Up.exchange(false) || Forked)
    return;
  isOk(rcl_node_fini(&Node));
  isOk(rcl_shutdown(&Context));
  isOk(rcl_context_fini(&Context));
}

} // namespace tpc
