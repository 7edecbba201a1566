//===- RclState.cpp -------------------------------------------------------===//
#include "RclState.h"

#include "Clock.h"
#include "ReadNames.h"
#include "Ros.h"
#include "Runtime.h"

#include <cstring>
#include <dlfcn.h>
#include <mutex>
#include <set>

namespace tpc {

/// What rcl returns.
static constexpr int32_t Ok = 0, Error = 1;

RclState &RclState::of() {
  static auto &Only = *new RclState;
  return Only;
}

/// The function \p Name of rcl itself.
template <typename Function> static Function *next(const char *Name) {
  void *Found = dlsym(RTLD_NEXT, Name);
  if (!Found)
    // rcl was loaded for one library alone.
    if (void *Rcl = dlopen("librcl.so", RTLD_NOW | RTLD_NOLOAD)) {
      Found = dlsym(Rcl, Name);
      dlclose(Rcl);
    }
  return reinterpret_cast<Function *>(Found);
}

static void noteNode(const void *Node, const char *Name) {
  // The backend makes a node of this name.
  if (!std::strcmp(Name, "_tpc"))
    return;
  static auto *FullName =
      next<const char *(const void *)>("rcl_node_get_fully_qualified_name");
  const char *Full = FullName ? FullName(Node) : nullptr;
  if (!Full)
    return;
  ReadNames::all().addNode(Full, Node, 1);
  RclState &S = RclState::of();
  ++S.Nodes;
  if (S.Node.load())
    return;
  static auto *DomainOf =
      next<int32_t(const void *, size_t *)>("rcl_node_get_domain_id");
  size_t Domain = 0;
  if (DomainOf && DomainOf(Node, &Domain) == Ok)
    S.Domain = static_cast<int64_t>(Domain);
  const char *Kept = strdup(Full), *Nobody = nullptr;
  S.NodeSince = Clock::steady();
  S.Node.compare_exchange_strong(Nobody, Kept);
}

/// Notes whether \p Clock follows /clock.
static void noteClock(const void *Clock, bool Follows) {
  static auto &Lock = *new std::mutex;
  static auto &Following = *new std::set<const void *>;
  std::lock_guard<std::mutex> Guard(Lock);
  if (Follows)
    Following.insert(Clock);
  else
    Following.erase(Clock);
  RclState::of().IsSimulated = !Following.empty();
}

} // namespace tpc

using namespace tpc;

// Their names are those of rcl. NOLINTBEGIN(readability-identifier-naming)
#define TPC_OF_RCL extern "C" __attribute__((visibility("default"))) int32_t

TPC_OF_RCL rcl_node_init(void *Node, const char *Name, const char *Namespace,
                         void *Context, const void *Options) {
  static auto *Next = next<decltype(rcl_node_init)>("rcl_node_init");
  if (!Next)
    return Error;
  const int32_t Result = Next(Node, Name, Namespace, Context, Options);
  if (Result == Ok && Name)
    noteNode(Node, Name);
  return Result;
}

TPC_OF_RCL rcl_enable_ros_time_override(void *Clock) {
  static auto *Next = next<decltype(rcl_enable_ros_time_override)>(
      "rcl_enable_ros_time_override");
  if (!Next)
    return Error;
  const int32_t Result = Next(Clock);
  if (Result == Ok)
    noteClock(Clock, true);
  return Result;
}

TPC_OF_RCL rcl_disable_ros_time_override(void *Clock) {
  static auto *Next = next<decltype(rcl_disable_ros_time_override)>(
      "rcl_disable_ros_time_override");
  if (!Next)
    return Error;
  const int32_t Result = Next(Clock);
  if (Result == Ok)
    noteClock(Clock, false);
  return Result;
}

TPC_OF_RCL rcl_set_ros_time_override(void *Clock, int64_t Ns) {
  static auto *Next =
      next<decltype(rcl_set_ros_time_override)>("rcl_set_ros_time_override");
  if (!Next)
    return Error;
  const int32_t Result = Next(Clock, Ns);
  if (Result == Ok)
    RclState::of().SimulatedNs = Ns;
  return Result;
}

TPC_OF_RCL rcl_clock_fini(void *Clock) {
  static auto *Next = next<decltype(rcl_clock_fini)>("rcl_clock_fini");
  if (!Next)
    return Error;
  noteClock(Clock, false);
  return Next(Clock);
}

TPC_OF_RCL rcl_shutdown(void *Context) {
  static auto *Next = next<decltype(rcl_shutdown)>("rcl_shutdown");
  if (!Next)
    return Error;
  const int32_t Result = Next(Context);
  ++RclState::of().Shutdowns;
  return Result;
}
// NOLINTEND(readability-identifier-naming)
