//===- Config.h - The settings --------------------------------------------===//
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
  uint64_t SiteCap = 0;          ///< reports per second; 0: no cap
  uint64_t ProcessCap = 0;       ///< reports per second; 0: no cap
  std::string Folder;            ///< empty: $ROS_HOME/tpc, else ~/.ros/tpc
  uint64_t FileLimitMiB = 4096;  ///< per file; 0: no limit
  uint64_t FileReserveMiB = 256; ///< kept free on the disk

  bool operator==(const Config &Other) const;
};

/// All names that parse() accepts, as in the ROS parameter; the variable of the
/// environment is `TPC_` and the name in capitals.
extern const char *const ConfigNames[8];

/// Sets the setting \p Name (`sink`, `policy`, `period`, ...) to \p Value. If
/// the value is invalid, returns false, leaves \p C unchanged and sets \p Why
/// to one clause.
bool parse(Config &C, const std::string &Name, const std::string &Value,
           std::string &Why);

/// The defaults, overridden by the environment. An invalid value logs a warning
/// and leaves the default: a node is never stopped because of it.
Config configOfEnvironment();

const char *text(SinkKind K);
const char *text(Policy P);

} // namespace tpc

#endif // TPC_CONFIG_H
