//===- Backends.cpp - Loads what knows the ROS of this process ------------===//
#include "Modes.h"
#include "RclState.h"
#include "ReadNames.h"
#include "Ros.h"
#include "Runtime.h"

#include <atomic>
#include <cstring>
#include <dlfcn.h>
#include <link.h>
#include <mutex>
#include <string_view>

namespace tpc {
namespace {

constexpr int64_t Ms = 1'000'000;
constexpr int64_t SoonNs = 20 * Ms;
constexpr int64_t LateNs = 250 * Ms;
/// For this many polls, looks often whether ROS was loaded; after that seldom.
constexpr int SoonPolls = 500;

std::atomic<Backend *> Loaded{nullptr};
/// Why the backend of the ROS that is loaded is not; never freed.
std::atomic<const std::string *> Missing{nullptr};

class TheHost final : public Host {
public:
  Config current() override { return tpc::current(); }
  bool apply(const Config &C) override { return tpc::apply(C); }
  std::string statusLine() override { return tpc::statusLine(); }
  void wakeHelper() override { tpc::wakeHelper(); }
  void endRuntime() override { tpc::endRuntime(); }
  void warn(const std::string &Text) override { tpc::warn(Text); }
  const RclState &rcl() override { return RclState::of(); }
};

/// The libraries of ROS in this process.
struct Found {
  unsigned long long Loads = 0; ///< of libraries so far
  bool HasRos1 = false;
  bool HasRos2 = false;
  std::string RclFolder; ///< with the slash
};

int look(dl_phdr_info *Info, size_t, void *To) {
  auto &F = *static_cast<Found *>(To);
  F.Loads = Info->dlpi_adds;
  const std::string_view Path = Info->dlpi_name ? Info->dlpi_name : "";
  const size_t Slash = Path.rfind('/') + 1;
  const std::string_view Name = Path.substr(Slash);
  if (Name.rfind("libroscpp.so", 0) == 0)
    F.HasRos1 = true;
  if (Name.rfind("librcl.so", 0) == 0) {
    F.HasRos2 = true;
    F.RclFolder = Path.substr(0, Slash);
  }
  return 0;
}

/// The folder of this library, with the slash.
std::string ownFolder() {
  Dl_info Info;
  if (!dladdr(reinterpret_cast<void *>(&look), &Info) || !Info.dli_fname)
    return "";
  const std::string Path = Info.dli_fname;
  return Path.substr(0, Path.rfind('/') + 1);
}

/// The messages that the backend of ROS 2 uses. A program need not have loaded
/// them; they are beside rcl, wherever that is.
void loadMessages(const std::string &Folder) {
  for (const char *Package :
       {"builtin_interfaces", "rcl_interfaces", "std_msgs"})
    for (const char *Part :
         {"__rosidl_generator_c.so", "__rosidl_typesupport_c.so"}) {
      const std::string Name = std::string("lib") + Package + Part;
      if (!dlopen((Folder + Name).c_str(), RTLD_NOW | RTLD_LOCAL))
        dlopen(Name.c_str(), RTLD_NOW | RTLD_LOCAL);
    }
}

void load(const std::string &Name) {
  const std::string Path = ownFolder() + Name;
  void *Library = dlopen(Path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void *Make = Library ? dlsym(Library, MakeBackendName) : nullptr;
  if (Make) {
    // Never destroyed, nor is its vtable before this library's own end.
    static auto &Only = *new TheHost;
    Loaded = reinterpret_cast<MakeBackend *>(Make)(Only);
    return;
  }
  const char *Error = dlerror();
  Missing = new std::string(Error ? Error : Path + " is of another release");
}

/// Loads the backend if the process has loaded ROS since the last call.
void lookForRos() {
  static std::mutex Looking;
  static unsigned long long LooksAt = 0;
  if (Loaded || Missing || !Looking.try_lock())
    return;
  std::lock_guard<std::mutex> Guard(Looking, std::adopt_lock);
  Found F;
  dl_iterate_phdr(look, &F);
  if (Loaded || Missing || F.Loads == LooksAt)
    return;
  LooksAt = F.Loads;
  // A bridge has both; it reports as it did when there was ROS 1 only.
  if (F.HasRos1)
    return load("libtpc_log_ros1.so");
  if (!F.HasRos2)
    return;
  RclState::takeOver();
  loadMessages(F.RclFolder);
  load("libtpc_log_ros2.so");
}

/// The first look is as early as that of the dynamic linker, when no lock of
/// this library is held and no report is lost or gets the wrong time.
[[gnu::constructor]] void lookAtFirst() {
  try {
    lookForRos();
  } catch (...) {
    // The helper thread looks again.
  }
}

} // namespace

Backend *rosBackend() { return Loaded.load(std::memory_order_acquire); }

int64_t pollRos() {
  static int Polls = 0; // by the helper thread
  try {
    lookForRos();
    if (Backend *B = rosBackend())
      return B->poll();
    if (Missing)
      return -1;
  } catch (...) {
    return LateNs;
  }
  return Polls < SoonPolls ? (++Polls, SoonNs) : LateNs;
}

std::string whyNoRos() {
  if (const std::string *Why = Missing)
    return *Why;
  Backend *B = rosBackend();
  return B ? B->failure() : "";
}

void rosEnd(bool IsInterrupted) {
  if (Backend *B = rosBackend())
    B->end(IsInterrupted);
}

bool forkedFromNode() {
  Backend *B = rosBackend();
  return B && B->isForked();
}

const char *rosNodeName() {
  Backend *B = rosBackend();
  return B ? B->nodeName() : "";
}

bool rosTimeIsSimulated() {
  Backend *B = rosBackend();
  return B && B->timeIsSimulated();
}

int64_t rosNow() {
  Backend *B = rosBackend();
  return B ? B->now() : 0;
}

std::string resolveName(const void *Handle, const std::string &Name) {
  Backend *B = rosBackend();
  return B ? B->resolveName(Handle, Name) : "";
}

} // namespace tpc
