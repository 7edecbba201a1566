//===- RclState.h - What the program has told rcl -------------------------===//
//
// Programs of ROS 2 call rcl through rclcpp, and this library is before rcl in
// the order in which the dynamic linker looks for functions: it has functions
// of the same names, which take notes and call those of rcl. They use no header
// of rcl; its structures are only passed on.
//
// A container of components that TPC has not built loads rcl, and makes a node,
// before this library. Its later calls are taken over (LateCalls.h).
//
//===----------------------------------------------------------------------===//
#ifndef TPC_RCLSTATE_H
#define TPC_RCLSTATE_H

#include <atomic>
#include <cstdint>

namespace tpc {

struct RclState {
  /// The full name of the first node; null before it. Never freed.
  std::atomic<const char *> Node{nullptr};
  std::atomic<int64_t> NodeSince{0}; ///< steady time
  /// How many nodes were made.
  std::atomic<uint32_t> Nodes{0};
  /// Whether rcl was there first. The program may have made other nodes before,
  /// and this is the full name of the first one that is known; never freed.
  std::atomic<bool> IsLate{false};
  std::atomic<const char *> LateNode{nullptr};
  /// The number of that node's graph; -1 if it is not known.
  std::atomic<int64_t> Domain{-1};
  /// Whether a clock of the program follows /clock, and what it was last told.
  std::atomic<bool> IsSimulated{false};
  std::atomic<int64_t> SimulatedNs{0};
  /// How many contexts were shut down.
  std::atomic<uint32_t> Shutdowns{0};

  /// That of this process, in the log library.
  static RclState &of();

  /// The program has said the name of a node to this library.
  void noteName(const char *Full);

  /// Once rcl is loaded: takes over the calls that are not for this library.
  static void takeOver();
};

} // namespace tpc

#endif // TPC_RCLSTATE_H
