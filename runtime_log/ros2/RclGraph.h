//===- RclGraph.h - The hidden node of the log library --------------------===//
//
// It is in a context of its own: that of the program may be shut down, made
// again, or live in another thread. Used by the helper thread, and by the
// thread that ends the process once the helper has ended.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_RCLGRAPH_H
#define TPC_RCLGRAPH_H

#include <rcl/context.h>
#include <rcl/node.h>

#include <atomic>
#include <string>

namespace tpc {

class RclGraph {
public:
  static RclGraph &of();

  /// Why the rcl of this process is not the one that this was built for; empty
  /// if it is, as far as is known.
  static std::string mismatch();

  /// Makes the node `NAME/_tpc`. If that fails, returns false and sets \p Why.
  bool begin(const std::string &Name, std::string &Why);
  void end();
  bool isUp() const { return Up; }
  rcl_node_t &node() { return Node; }

  /// Whether this process was forked from one that was a node.
  bool isForked() const { return Forked; }

  /// `/ns/name` of the process.
  const char *name() const;
  /// Names the process, which has not told rcl of a node; see RclState.h.
  void setName(const std::string &Name);

private:
  RclGraph();

  rcl_context_t Context = rcl_get_zero_initialized_context();
  rcl_node_t Node = rcl_get_zero_initialized_node();
  std::atomic<bool> Up{false};
  std::atomic<bool> Forked{false};
  std::atomic<const char *> OwnName{nullptr}; ///< never freed
};

} // namespace tpc

#endif // TPC_RCLGRAPH_H
