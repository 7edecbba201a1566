//===- Backend.h - Between the log library and the ROS of a process -------===//
//
// The log library links no ROS. What needs ROS is in a library beside it for
// each ROS: libtpc_log_ros1.so and libtpc_log_ros2.so. Backends.cpp loads the
// one whose ROS the process has loaded. Each is built together with the log
// library, so these classes may change.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_BACKEND_H
#define TPC_BACKEND_H

#include "Config.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace tpc {

struct RclState;

/// What a backend may ask of the log library; Runtime.h describes most of it.
class Host {
public:
  virtual Config current() = 0;
  virtual bool apply(const Config &C) = 0;
  virtual std::string statusLine() = 0;
  virtual void wakeHelper() = 0;
  virtual void endRuntime() = 0;
  virtual void warn(const std::string &Text) = 0;

  /// What the program has told rcl.
  virtual const RclState &rcl() = 0;

protected:
  ~Host() = default;
};

/// Reports that wait in a sink.
class Outbox {
public:
  /// \p Node is the one whose report it is; null for the one that the process
  /// is named after, and for a text of several lines.
  using Take =
      std::function<void(int64_t Stamp, std::string Text, const char *Node)>;

  /// How many listen. If any do, the sink wakes the helper thread for new
  /// reports; who has come since the last call gets all names.
  virtual void setSubscribers(size_t Count) = 0;

  /// Passes what waits to \p Send as texts of messages, each with a ROS time in
  /// nanoseconds, if it has waited for long enough or with \p AtOnce.
  ///
  /// \returns whether something was passed.
  virtual bool send(bool AtOnce, const Take &Send) = 0;

protected:
  ~Outbox() = default;
};

/// A topic that a sink sends on. Never destroyed.
class Channel {
public:
  /// How many reports were sent: the number of the first one of a batch.
  std::atomic<uint64_t> Sent{0};

  virtual const char *topic() const = 0;
  /// Stands before a batch.
  virtual const char *prefix() const { return ""; }
  /// Ends the first line of a batch.
  virtual std::string head() const { return ""; }

  /// Whether poll() has nothing to do until somebody subscribes.
  virtual bool isAdvertised() const = 0;
  /// Whether poll() may see a subscriber that setSubscribers() was not told of.
  virtual bool hasToLook() const { return false; }

  /// From the helper thread, about every 20 ms while the sink is chosen and
  /// there is something to do: advertises, and sends what is due.
  virtual void poll(Outbox &From) = 0;
  /// The sink was left, or the process ends: sends everything that waits, and
  /// gives the subscribers a moment for it.
  virtual void end(Outbox &From) = 0;

protected:
  ~Channel() = default;
};

/// One ROS. Never destroyed; calls may come from any thread unless they say
/// otherwise, and never throw.
class Backend {
public:
  /// From the helper thread, which holds no lock: does what ROS asks for.
  ///
  /// \returns after how many nanoseconds to call it again; -1: only after
  /// wakeHelper() was called.
  virtual int64_t poll() = 0;

  /// The process ends. \p IsInterrupted: inside of a report, which may hold any
  /// lock, so that this must neither wait for one nor use the heap.
  virtual void end(bool IsInterrupted) = 0;

  /// Whether this process was forked from one that used this ROS, whose threads
  /// are missing here and whose locks may stay locked.
  virtual bool isForked() = 0;

  /// The name of this process's node; empty if it is not known (yet).
  virtual const char *nodeName() = 0;

  /// Whether the node's time is simulated.
  virtual bool timeIsSimulated() = 0;

  /// The node's time in nanoseconds; 0 if it is not known yet.
  virtual int64_t now() = 0;

  /// See ReadNames.h.
  virtual std::string resolveName(const void *Handle,
                                  const std::string &Name) = 0;

  /// The topic of the sink Auto, Rosout or Topic. With Rosout each report is a
  /// message.
  virtual Channel &channel(SinkKind K) = 0;

  /// Why this ROS cannot be used; empty if it can, as far as is known.
  virtual std::string failure() { return ""; }

protected:
  ~Backend() = default;
};

/// What a backend's library defines.
using MakeBackend = Backend *(Host &);
constexpr const char *MakeBackendName = "tpc_make_backend";

} // namespace tpc

extern "C" __attribute__((visibility("default"))) tpc::Backend *
tpc_make_backend(tpc::Host &Of);

#endif // TPC_BACKEND_H
