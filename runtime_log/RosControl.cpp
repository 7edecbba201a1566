//===- RosControl.cpp -----------------------------------------------------===//
#include "RosControl.h"
#include "Sink.h"

namespace tpc {

Sink &topicSink() { return rosoutSink(); }
int64_t rosTurn() { return -1; }
void rosEnd() {}
bool rosIsInitialized() { return false; }
const char *rosNodeName() { return ""; }
bool rosTimeIsSimulated() { return false; }
int64_t rosNow() { return 0; }

} // namespace tpc
