//===- ControlDependence.h - Control dependence of a flow graph -----------===//
//
// Control dependence as Ferrante, Ottenstein and Warren define it ("The program
// dependence graph and its use in optimization", TOPLAS 1987): node Y depends
// on X if X has an edge after which Y is always reached, and X itself does not
// always lead to Y. Post-dominators are computed by the iteration of Cooper,
// Harvey and Kennedy ("A simple, fast dominance algorithm", 2001).
//
// The graph is given as nodes 0..n-1 with successor lists. This file does not
// depend on LLVM IR.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CONTROLDEPENDENCE_H
#define TPC_CONTROLDEPENDENCE_H

#include <vector>

namespace tpc {

using FlowGraph = std::vector<std::vector<unsigned>>;

/// The nodes of \p Graph that can be reached from \p Roots, including \p Roots.
std::vector<bool> reachedFrom(const FlowGraph &Graph,
                              std::vector<unsigned> Roots);

/// For each node, the nodes that it directly depends on, ascending. An endless
/// loop gets an exit after each round, so that its inner branches still count.
std::vector<std::vector<unsigned>> controlDependence(const FlowGraph &Graph);

} // namespace tpc

#endif // TPC_CONTROLDEPENDENCE_H
