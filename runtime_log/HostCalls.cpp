//===- HostCalls.cpp - The log library, as a backend sees it --------------===//
#include "HostCalls.h"
#include "Modes.h"
#include "Runtime.h"

namespace tpc {

static Host *Of = nullptr;

void setHost(Host &H) { Of = &H; }
Host &host() { return *Of; }

Config current() { return Of->current(); }
bool apply(const Config &C) { return Of->apply(C); }
std::string statusLine() { return Of->statusLine(); }
void wakeHelper() { Of->wakeHelper(); }
void endRuntime() { Of->endRuntime(); }
void warn(const std::string &Text) { Of->warn(Text); }

} // namespace tpc
