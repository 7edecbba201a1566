//===- ControlDependence.h - Control dependence of a flow graph -----------===//
//
// Control dependence as Ferrante, Ottenstein and Warren define it ("The
// program dependence graph and its use in optimization", TOPLAS 1987): node Y
// depends on X where an edge leaves X after which Y must be reached, while X
// itself need not lead to Y. Post-dominators are found by the iteration of
// Cooper, Harvey and Kennedy ("A simple, fast dominance algorithm", 2001).
//
// The graph is nodes 0..n-1 and successor lists; it knows nothing of LLVM.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CONTROLDEPENDENCE_H
#define TPC_CONTROLDEPENDENCE_H

#include <vector>

namespace tpc {

using FlowGraph = std::vector<std::vector<unsigned>>;

/// The nodes of \p Graph that can be reached from \p Roots, themselves
/// included.
std::vector<bool> reachedFrom(const FlowGraph &Graph,
                              std::vector<unsigned> Roots);

/// For each node the nodes that it is directly control dependent on,
/// ascending. A loop that never ends is given an end after any round of it, so
/// that its inner branches still count.
std::vector<std::vector<unsigned>> controlDependence(const FlowGraph &Graph);

} // namespace tpc

#endif // TPC_CONTROLDEPENDENCE_H
