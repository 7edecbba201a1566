//===- HostCalls.h - The log library, as a backend sees it ----------------===//
//
// A backend's library has the functions of Runtime.h, which call those of the
// log library.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_HOSTCALLS_H
#define TPC_HOSTCALLS_H

#include "Backend.h"

namespace tpc {

/// Before anything else is used.
void setHost(Host &H);
Host &host();

} // namespace tpc

#endif // TPC_HOSTCALLS_H
