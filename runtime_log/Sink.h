//===- Sink.h - Where reports go ------------------------------------------===//
#ifndef TPC_SINK_H
#define TPC_SINK_H

#include "Report.h"

namespace tpc {

/// Takes what is reported. There is one of each kind in a process, for ever: it
/// may be chosen, left and chosen again, and threads may still be inside take()
/// when it was left. No call ever comes from within another one in the same
/// thread.
class Sink {
public:
  virtual ~Sink() = default;

  /// One report; from any thread, many at once.
  virtual void take(const Report &R) = 0;

  /// From the helper thread, or from the thread that ends the process.
  virtual void take(const Summary &S) = 0;
  virtual void take(const Dropped &D) = 0;

  /// From the helper thread, about every 20 ms while this is the chosen sink.
  virtual void turn() {}

  /// Whether turn() has anything to do: where not, the helper thread sleeps.
  virtual bool wantsTurns() const { return false; }

  /// The sink was left, or the process ends: what waits is sent now.
  virtual void end() {}

  /// For the status line: what a user wants to know of it, e.g. `file=PATH`.
  virtual std::string status() const { return ""; }
};

/// The thesis's: one ROS_INFO line a report, which appears on /rosout.
Sink &rosoutSink();

/// Batches on /threshold_information.
Sink &topicSink();

} // namespace tpc

#endif // TPC_SINK_H
