//===- Runtime.h - The chosen settings, and the helper thread -------------===//
#ifndef TPC_RUNTIME_H
#define TPC_RUNTIME_H

#include "Config.h"

namespace tpc {

/// The settings in force.
Config current();

/// Applies \p C, from any thread. If the sink is not available (no file), logs
/// a warning and keeps the previous settings; returns whether \p C is applied.
bool apply(const Config &C);

/// `sink=file policy=edges reports=123 dropped=0 file=...`: one line.
std::string statusLine();

/// Makes the helper thread check everything at once. From any thread.
void wakeHelper();

/// Writes one line to standard error: `tpc: ` and \p Text.
void warn(const std::string &Text);

} // namespace tpc

#endif // TPC_RUNTIME_H
