//===- Config.h - The settings --------------------------------------------===//
#ifndef TPC_CONFIG_H
#define TPC_CONFIG_H

#include <cstddef>
#include <cstdint>
#include <string>

namespace tpc {

enum class SinkKind : uint8_t {
  Auto, ///< batches on /rosout; nowhere in a program without ROS
  Rosout,
  Topic,
  File,
  Off
};

enum class Policy : uint8_t {
  Every, ///< each evaluation
  Edges, ///< each flop, and a summary of each period
  Light, ///< flops up to a cap, and a summary of a sample
  OfSink ///< not chosen: light for Auto, every for the others
};

struct Config {
  /// A ring has about so many files.
  static constexpr uint64_t Segments = 8;
  /// Of the numbers: what is usual for the policy.
  static constexpr uint64_t Usual = UINT64_MAX;

  SinkKind Sink = SinkKind::Auto;
  tpc::Policy Policy = Policy::OfSink;
  uint64_t PeriodNs = Usual;
  uint64_t SiteCap = Usual;      ///< reports per second; 0: no cap
  uint64_t ProcessCap = Usual;   ///< reports per second; 0: no cap
  std::string Folder;            ///< empty: $ROS_HOME/tpc, else ~/.ros/tpc
  uint64_t FileLimitMiB = 4096;  ///< per file; 0: no limit
  uint64_t FileReserveMiB = 256; ///< kept free on the disk
  uint64_t RingNs = 0;           ///< what a ring of files keeps; 0: no ring
  uint64_t RingBudgetMiB = 64;   ///< of all files of the ring of this process

  bool operator==(const Config &Other) const;

  bool hasRing() const { return RingNs != 0; }
  /// The share of one file in what the ring of this process may take.
  uint64_t segmentBytes() const;

  /// With everything that was not chosen filled in.
  Config filledIn() const;
};

/// All names that parse() accepts; the variable of the environment is `TPC_`
/// and the name in capitals. Those that come first may be ROS parameters as
/// well. The others say where files go and how large they grow: everybody who
/// reaches the ROS master can set a parameter, so the environment alone
/// decides.
extern const char *const ConfigNames[10];
constexpr size_t ParameterNames = 5;

/// The variable of the environment for a setting.
std::string variableOf(const std::string &Name);

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
