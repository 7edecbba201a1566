//===- NodeRanges.h - Which object belongs to which node ------------------===//
//
// A process of ROS 2 may have several nodes: a container of components, a
// controller with its costmaps. The node of an object is known
//
// - if it is the node itself, or lies within it;
// - or if a method of it, or of an object that contains it, has read a
//   parameter of the node.
//
// If several of these hold, the smallest such object counts.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_NODERANGES_H
#define TPC_NODERANGES_H

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace tpc {

class NodeRanges {
public:
  static constexpr size_t Most = 10'000;

  /// What lies in these \p Size bytes belongs to \p Node. Beyond Most ranges
  /// nothing is kept.
  void add(const std::string &Node, const void *Object, uint64_t Size);

  /// The same for a node that was just made: what is known of objects within it
  /// was of others that are gone.
  ///
  /// \returns whether some of those belonged to another node.
  bool replace(const std::string &Node, const void *Object, uint64_t Size);

  /// The name of the node of \p Object; null if it is not known. Never freed.
  const std::string *of(const void *Object) const;

private:
  std::set<std::string> Names;
  /// By begin and end.
  std::map<std::pair<uintptr_t, uintptr_t>, const std::string *> Ranges;
};

} // namespace tpc

#endif // TPC_NODERANGES_H
