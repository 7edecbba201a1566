//===- Config.h - What a process reports, and where to --------------------===//
#ifndef TPC_CONFIG_H
#define TPC_CONFIG_H

#include <cstdint>
#include <string>

namespace tpc {

enum class SinkKind : uint8_t { Rosout, Topic, File, Off };

enum class Policy : uint8_t {
  Every, ///< each evaluation
  Edges  ///< each flop, and a summary of each period
};

struct Config {
  SinkKind Sink = SinkKind::Rosout;
  tpc::Policy Policy = Policy::Every;
  int64_t PeriodNs = 100'000'000;
  uint64_t SiteCap = 0;          ///< reports a second; 0: no cap
  uint64_t ProcessCap = 0;       ///< reports a second; 0: no cap
  std::string Folder;            ///< empty: $ROS_HOME/tpc, else ~/.ros/tpc
  uint64_t FileLimitMiB = 4096;  ///< of one file; 0: none
  uint64_t FileReserveMiB = 256; ///< left free on the disk

  bool operator==(const Config &Other) const;
};

/// Every name that parse() knows, as it is in the ROS parameter; in the
/// environment it is `TPC_` and the name in capitals.
extern const char *const ConfigNames[8];

/// Sets what \p Name (`sink`, `policy`, `period`, ...) says to \p Value. Where
/// that is no value of it, \p C is as it was and \p Why says so in one clause.
bool parse(Config &C, const std::string &Name, const std::string &Value,
           std::string &Why);

/// The defaults and the environment. What is set wrongly gets a warning and is
/// left at its default: a node is never stopped for this.
Config configOfEnvironment();

const char *text(SinkKind K);
const char *text(Policy P);

} // namespace tpc

#endif // TPC_CONFIG_H
