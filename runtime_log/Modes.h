//===- Modes.h - The state that log_one reads -----------------------------===//
#ifndef TPC_MODES_H
#define TPC_MODES_H

#include "Layout.h"
#include "LogFile.h"
#include "Sink.h"
#include "Sites.h"

#include <atomic>

/// Whether reports are wanted; instrumented code checks it before it calls
/// log_one. A program may define its own, weakly, which replaces that of the
/// library.
extern "C" __attribute__((visibility("default"))) char tpc_reporting;

namespace tpc {

/// The cases that log_one distinguishes.
enum class Mode : uint8_t {
  NotStarted,
  Off,
  FileEvery, ///< each evaluation, to the file
  Edges,
  Light,
  SinkEvery, ///< each evaluation, to another sink
  Capped     ///< each evaluation that the caps allow
};

extern std::atomic<Mode> NowMode;
extern std::atomic<LogFile *> NowFile;
extern std::atomic<Sink *> NowSink;
/// Whether the chosen sink is the file.
extern std::atomic<bool> ReportsToFile;
/// Whether a ring is written: as the chosen sink, or beside it.
extern std::atomic<bool> RingRuns;
/// Where summaries go: to the chosen sink, and to the ring.
Sink &summarySink();
/// In a second of real time.
extern std::atomic<uint64_t> SiteCap, ProcessCap;
extern Meter ProcessMeter;
/// In place of it, under the policy `light`.
extern FairMeter FairProcessMeter;

/// Set before the mode changes from NotStarted.
extern Sites *TheSites;
inline Sites &sites() { return *TheSites; }

/// Reads the settings and starts the helper thread, once per process.
void startRuntime();

/// Sends what is waiting and ends the helper thread, once per process: at exit,
/// or earlier if something that it needs is about to be destroyed.
void endRuntime();

/// Whether the caps forbid one more report of \p S; if so, it is counted as
/// dropped.
bool isOverCap(Site &S, bool IsFlop);

/// Passes \p R to the chosen sink; \p Bits are those of the records in a file.
void emit(Thread &T, Site &S, const Report &R, uint32_t Bits);

/// Whether the file of the ring does not have the outcome of \p S yet.
inline bool isNewToRing(const Site &S) {
  return RingRuns.load(std::memory_order_relaxed) &&
         S.StatedIn.load(std::memory_order_relaxed) !=
             NowFile.load(std::memory_order_relaxed);
}

/// Of a report in a file: the policy has the evaluation in a summary, too.
inline uint32_t edgeBit() {
  const Mode M = NowMode.load();
  return M == Mode::Edges || M == Mode::Light ? layout::EdgeBit : 0;
}

} // namespace tpc

#endif // TPC_MODES_H
