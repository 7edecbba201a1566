//===- ControlDependence.cpp ----------------------------------------------===//
#include "ControlDependence.h"

#include "Budget.h"

#include <algorithm>

namespace tpc {

namespace {

constexpr unsigned None = ~0U;

/// The graph turned round, with one more node: the exit, from which every
/// node can be reached.
class ReverseGraph {
public:
  explicit ReverseGraph(const FlowGraph &Graph);

  /// Immediate post-dominator of each node; None for the exit.
  std::vector<unsigned> postDominators() const;

  unsigned exit() const { return static_cast<unsigned>(Preds.size()) - 1; }
  const FlowGraph &successors() const { return Succs; }

private:
  void addExit(unsigned Node);
  std::vector<bool> reachingExit() const;
  std::vector<unsigned> postOrder() const;

  FlowGraph Succs; ///< of the original direction, exit edges included
  FlowGraph Preds;
};

/// Nodes of \p Graph in post-order from \p Roots, one after the other.
std::vector<unsigned> postOrderFrom(const FlowGraph &Graph,
                                    const std::vector<unsigned> &Roots) {
  std::vector<unsigned> Order;
  std::vector<bool> Seen(Graph.size());
  std::vector<std::pair<unsigned, size_t>> Stack;
  for (unsigned Root : Roots) {
    if (Seen[Root])
      continue;
    Seen[Root] = true;
    Stack.push_back({Root, 0});
    while (!Stack.empty()) {
      auto &[Node, Next] = Stack.back();
      if (Next == Graph[Node].size()) {
        Order.push_back(Node);
        Stack.pop_back();
        continue;
      }
      unsigned Succ = Graph[Node][Next++];
      if (!Seen[Succ]) {
        Seen[Succ] = true;
        Stack.push_back({Succ, 0});
      }
    }
  }
  return Order;
}

ReverseGraph::ReverseGraph(const FlowGraph &Graph)
    : Succs(Graph), Preds(Graph.size() + 1) {
  Succs.emplace_back();
  std::vector<unsigned> Roots;
  for (unsigned N = 0; N < Graph.size(); ++N) {
    Roots.push_back(N);
    for (unsigned S : Graph[N])
      Preds[S].push_back(N);
  }
  for (unsigned N = 0; N < Graph.size(); ++N)
    if (Graph[N].empty())
      addExit(N);
  // Post-order visits what lies deepest first, so the first node that cannot
  // reach the exit is the last one of its region in reverse post-order.
  std::vector<bool> Reaching = reachingExit();
  for (unsigned N : postOrderFrom(Graph, Roots))
    if (!Reaching[N] && !Budget::isSpent()) {
      addExit(N);
      Reaching = reachingExit();
    }
}

void ReverseGraph::addExit(unsigned Node) {
  Succs[Node].push_back(exit());
  Preds[exit()].push_back(Node);
}

std::vector<bool> ReverseGraph::reachingExit() const {
  std::vector<bool> Seen(Preds.size());
  std::vector<unsigned> Work{exit()};
  Seen[exit()] = true;
  while (!Work.empty()) {
    unsigned N = Work.back();
    Work.pop_back();
    for (unsigned P : Preds[N])
      if (!Seen[P]) {
        Seen[P] = true;
        Work.push_back(P);
      }
  }
  return Seen;
}

std::vector<unsigned> ReverseGraph::postOrder() const {
  return postOrderFrom(Preds, {exit()});
}

std::vector<unsigned> ReverseGraph::postDominators() const {
  std::vector<unsigned> Order = postOrder();
  std::vector<unsigned> Number(Preds.size(), None);
  for (unsigned I = 0; I < Order.size(); ++I)
    Number[Order[I]] = I;
  std::vector<unsigned> Idom(Preds.size(), None);
  Idom[exit()] = exit();
  auto Intersect = [&](unsigned A, unsigned B) {
    while (A != B) {
      while (Number[A] < Number[B])
        A = Idom[A];
      while (Number[B] < Number[A])
        B = Idom[B];
    }
    return A;
  };
  for (bool Changed = true; Changed;) {
    Changed = false;
    for (auto It = Order.rbegin(); It != Order.rend(); ++It) {
      if (*It == exit())
        continue;
      if (Budget::isSpent())
        return {};
      unsigned New = None;
      for (unsigned S : Succs[*It])
        if (Idom[S] != None)
          New = New == None ? S : Intersect(S, New);
      if (New != Idom[*It]) {
        Idom[*It] = New;
        Changed = true;
      }
    }
  }
  Idom[exit()] = None;
  return Idom;
}

} // namespace

std::vector<std::vector<unsigned>> controlDependence(const FlowGraph &Graph) {
  ReverseGraph Reverse(Graph);
  std::vector<unsigned> Idom = Reverse.postDominators();
  std::vector<std::vector<unsigned>> Controllers(Graph.size());
  if (Idom.empty())
    return Controllers;
  for (unsigned Branch = 0; Branch < Graph.size(); ++Branch) {
    const std::vector<unsigned> &Succs = Reverse.successors()[Branch];
    if (Succs.size() < 2 || Budget::isSpent())
      continue;
    for (unsigned S : Succs)
      for (unsigned N = S; N != Idom[Branch] && N != Reverse.exit();
           N = Idom[N])
        Controllers[N].push_back(Branch);
  }
  for (std::vector<unsigned> &List : Controllers) {
    std::sort(List.begin(), List.end());
    List.erase(std::unique(List.begin(), List.end()), List.end());
  }
  return Controllers;
}

} // namespace tpc
