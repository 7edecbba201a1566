//===- Modes.h - What log_one looks at ------------------------------------===//
#ifndef TPC_MODES_H
#define TPC_MODES_H

#include "LogFile.h"
#include "Sink.h"
#include "Sites.h"

#include <atomic>

/// Whether reports are wanted: instrumented code looks at it before it calls
/// log_one. Each program may have one of its own, weakly, that takes the place
/// of the library's.
extern "C" __attribute__((visibility("default"))) char tpc_reporting;

namespace tpc {

/// The few ways of log_one.
enum class Mode : uint8_t {
  NotStarted,
  Off,
  FileEvery, ///< each evaluation to the file
  Edges,
  SinkEvery, ///< each evaluation to another sink
  Capped     ///< each evaluation, as far as the caps go
};

extern std::atomic<Mode> NowMode;
extern std::atomic<LogFile *> NowFile;
extern std::atomic<Sink *> NowSink;
/// Whether the chosen sink is the file.
extern std::atomic<bool> ReportsToFile;
extern std::atomic<uint64_t> SiteCap, ProcessCap;
extern Meter ProcessMeter;

/// There from when the mode is another than NotStarted.
extern Sites *TheSites;
inline Sites &sites() { return *TheSites; }

/// Reads the settings and starts the helper thread, once in a process.
void startRuntime();

/// Sends what waits and ends the helper thread, once in a process: at exit, or
/// earlier where what it needs is about to go.
void endRuntime();

/// Whether the caps leave no room for one more report of \p S; then it is
/// counted as dropped.
bool isOverCap(Site &S, bool IsFlop);

/// Gives \p R to the chosen sink; \p Bits are those of the file's records.
void emit(Thread &T, Site &S, const Report &R, uint32_t Bits);

} // namespace tpc

#endif // TPC_MODES_H
