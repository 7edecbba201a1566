//===- LogOne.cpp ---------------------------------------------------------===//
#include "LogOne.h"
#include "Sink.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace tpc {

/// The sink that TPC_SINK names, `rosout` where it names none. A name that is
/// none gets a warning and the default: a node is never stopped for this.
static Sink chosenSink() {
  const char *Name = std::getenv("TPC_SINK");
  if (!Name || !*Name || !std::strcmp(Name, "rosout"))
    return logToRosout;
  if (!std::strcmp(Name, "off"))
    return logNowhere;
  std::fprintf(stderr,
               "tpc: TPC_SINK=%s is no sink (rosout, off); using rosout\n",
               Name);
  return logToRosout;
}

} // namespace tpc

void log_one(char *key, bool result, double cmp, double thresh, bool res) {
  static const tpc::Sink Report = tpc::chosenSink();
  try {
    Report({key, result, cmp, thresh, res});
  } catch (...) {
    // A report that cannot be made is not worth a node.
  }
}
