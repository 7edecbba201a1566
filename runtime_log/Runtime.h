//===- Runtime.h - What is chosen, and the helper thread ------------------===//
#ifndef TPC_RUNTIME_H
#define TPC_RUNTIME_H

#include "Config.h"

namespace tpc {

/// What holds now.
Config current();

/// Makes \p C hold, from any thread. A sink that cannot be had (no file) gets a
/// warning and what held before holds on; returns whether it holds.
bool apply(const Config &C);

/// `sink=file policy=edges reports=123 dropped=0 file=...`: one line.
std::string statusLine();

/// Has the helper thread look at everything at once. From any thread.
void wakeHelper();

/// One line on standard error, behind `tpc: `.
void warn(const std::string &Text);

} // namespace tpc

#endif // TPC_RUNTIME_H
