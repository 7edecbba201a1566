//===- Sink.h - Where reports go ------------------------------------------===//
#ifndef TPC_SINK_H
#define TPC_SINK_H

#include "Report.h"

namespace tpc {

class LogFile;

/// Takes reports. There is one of each kind in a process, and it is never
/// destroyed. A sink may be chosen, left and chosen again, and threads may
/// still be inside take() after it was left. In one thread, a call never comes
/// from within another call.
class Sink {
public:
  virtual ~Sink() = default;

  /// One report; from any thread, concurrently.
  virtual void take(const Report &R) = 0;

  /// From the helper thread, or from the thread that ends the process.
  virtual void take(const Summary &S) = 0;
  virtual void take(const Dropped &D) = 0;

  /// From the helper thread, or from the thread that ends the process.
  virtual void take(const ReadName &) {}

  /// Whether a reader that comes later misses what was taken before.
  virtual bool forgets() const { return true; }

  /// From the helper thread, about every 20 ms while this is the chosen sink.
  virtual void poll() {}

  /// Whether poll() has anything to do. If not, the helper thread may sleep.
  virtual bool isPolled() const { return false; }

  /// The sink was left, or the process ends: sends what is waiting.
  virtual void end() {}

  /// The sink was left because its ROS cannot be used: everything that is
  /// waiting goes to \p To.
  virtual void giveTo(LogFile &To) { (void)To; }

  /// For the status line: what a user wants to know about it, such as
  /// `file=PATH`.
  virtual std::string status() const { return ""; }
};

/// The sink of the thesis: one message on /rosout for each report.
Sink &rosoutSink();

/// Sends batches on /threshold_information.
Sink &topicSink();

/// Sends batches: on /rosout with ROS 1, on /threshold_information with ROS 2.
/// Without ROS, reports go nowhere.
Sink &autoSink();

/// Around fork(), which may happen while another thread holds their locks.
/// Others are held where these are taken, so they are locked last. What waits
/// in a child belongs to its parent.
void lockStores();
void unlockStores(bool InChild);

} // namespace tpc

#endif // TPC_SINK_H
