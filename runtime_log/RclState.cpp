//===- RclState.cpp -------------------------------------------------------===//
#include "RclState.h"

#include "Clock.h"
#include "LateCalls.h"
#include "ReadNames.h"
#include "Ros.h"
#include "Runtime.h"

#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <iterator>
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

/// Keeps \p Full in \p To, for ever, if nothing is there.
static void keepFirst(std::atomic<const char *> &To, const char *Full) {
  const char *Nobody = nullptr;
  const char *Kept = strdup(Full);
  if (!To.compare_exchange_strong(Nobody, Kept))
    std::free(const_cast<char *>(Kept));
}

void RclState::noteName(const char *Full) {
  if (IsLate && !LateNode.load())
    keepFirst(LateNode, Full);
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
  if (S.Node.load() || S.LateNode.load())
    return;
  static auto *DomainOf =
      next<int32_t(const void *, size_t *)>("rcl_node_get_domain_id");
  size_t Domain = 0;
  if (DomainOf && DomainOf(Node, &Domain) == Ok)
    S.Domain = static_cast<int64_t>(Domain);
  S.NodeSince = Clock::steady();
  keepFirst(S.IsLate ? S.LateNode : S.Node, Full);
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

//===----------------------------------------------------------------------===//
// In place of rcl's functions
//===----------------------------------------------------------------------===//

static int32_t nodeInit(void *Node, const char *Name, const char *Namespace,
                        void *Context, const void *Options) {
  static auto *Next = next<decltype(nodeInit)>("rcl_node_init");
  if (!Next)
    return Error;
  const int32_t Result = Next(Node, Name, Namespace, Context, Options);
  if (Result == Ok && Name)
    noteNode(Node, Name);
  return Result;
}

static int32_t enableOverride(void *Clock) {
  static auto *Next =
      next<decltype(enableOverride)>("rcl_enable_ros_time_override");
  if (!Next)
    return Error;
  const int32_t Result = Next(Clock);
  if (Result == Ok)
    noteClock(Clock, true);
  return Result;
}

static int32_t disableOverride(void *Clock) {
  static auto *Next =
      next<decltype(disableOverride)>("rcl_disable_ros_time_override");
  if (!Next)
    return Error;
  const int32_t Result = Next(Clock);
  if (Result == Ok)
    noteClock(Clock, false);
  return Result;
}

static int32_t setOverride(void *Clock, int64_t Ns) {
  static auto *Next = next<decltype(setOverride)>("rcl_set_ros_time_override");
  if (!Next)
    return Error;
  const int32_t Result = Next(Clock, Ns);
  if (Result != Ok)
    return Result;
  RclState &S = RclState::of();
  S.SimulatedNs = Ns;
  if (S.IsLate) {
    // It may have been enabled before. Programs also set clocks that are not.
    static auto *IsEnabled =
        next<int32_t(void *, bool *)>("rcl_is_enabled_ros_time_override");
    bool Follows = false;
    if (IsEnabled && IsEnabled(Clock, &Follows) == Ok)
      noteClock(Clock, Follows);
  }
  return Result;
}

static int32_t clockFini(void *Clock) {
  static auto *Next = next<decltype(clockFini)>("rcl_clock_fini");
  if (!Next)
    return Error;
  noteClock(Clock, false);
  return Next(Clock);
}

static int32_t shutDown(void *Context) {
  static auto *Next = next<decltype(shutDown)>("rcl_shutdown");
  if (!Next)
    return Error;
  const int32_t Result = Next(Context);
  ++RclState::of().Shutdowns;
  return Result;
}

void RclState::takeOver() {
  Dl_info Own, Used;
  void *First = dlsym(RTLD_DEFAULT, "rcl_node_init");
  if (!First || !dladdr(First, &Used) ||
      !dladdr(reinterpret_cast<void *>(&nodeInit), &Own) ||
      Used.dli_fbase == Own.dli_fbase)
    return;
  of().IsLate = true;
  const auto Ours = [](auto *F) { return reinterpret_cast<void *>(F); };
  const LateCall Calls[] = {
      {"rcl_node_init", Ours(&nodeInit)},
      {"rcl_enable_ros_time_override", Ours(&enableOverride)},
      {"rcl_disable_ros_time_override", Ours(&disableOverride)},
      {"rcl_set_ros_time_override", Ours(&setOverride)},
      {"rcl_clock_fini", Ours(&clockFini)},
      {"rcl_shutdown", Ours(&shutDown)}};
  takeCalls(Calls, std::size(Calls));
}

} // namespace tpc

using namespace tpc;

// Their names are those of rcl. NOLINTBEGIN(readability-identifier-naming)
#define TPC_OF_RCL extern "C" __attribute__((visibility("default"))) int32_t

TPC_OF_RCL rcl_node_init(void *Node, const char *Name, const char *Namespace,
                         void *Context, const void *Options) {
  return nodeInit(Node, Name, Namespace, Context, Options);
}

TPC_OF_RCL rcl_enable_ros_time_override(void *Clock) {
  return enableOverride(Clock);
}

TPC_OF_RCL rcl_disable_ros_time_override(void *Clock) {
  return disableOverride(Clock);
}

TPC_OF_RCL rcl_set_ros_time_override(void *Clock, int64_t Ns) {
  return setOverride(Clock, Ns);
}

TPC_OF_RCL rcl_clock_fini(void *Clock) { return clockFini(Clock); }

TPC_OF_RCL rcl_shutdown(void *Context) { return shutDown(Context); }
// NOLINTEND(readability-identifier-naming)
