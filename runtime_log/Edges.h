//===- Edges.h - The policy `edges` ---------------------------------------===//
//
// Each flop is reported, and of all evaluations a summary is kept for each
// site, thread and period. A thread adds to its own slots without a lock, those
// of even and odd periods in turn; the helper thread begins a new period, waits
// until no thread is still inside of the old one, and takes its slots.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_EDGES_H
#define TPC_EDGES_H

#include "Sink.h"
#include "Sites.h"
#include "Threads.h"

namespace tpc {

/// The file that slots are in, where that is the sink; else null.
extern std::atomic<LogFile *> SlotsHome;

/// Takes in one evaluation.
void edges(Thread &T, Site &S, const Report &R);

/// Once in each helper thread, before the first flush.
void prepareEdges();

/// Begins a new period and gives the summaries of the old one to \p S; with
/// \p All those of a period that has just begun, too (no reports are expected
/// meanwhile, or they come into the next summaries).
void flushEdges(Sink &S, bool All);

} // namespace tpc

#endif // TPC_EDGES_H
