//===- ControlDependence.cpp ----------------------------------------------===//
#include "control/ControlDependence.h"

#include "support/Budget.h"

#include <algorithm>

namespace tpc {

std::vector<bool> reachedFrom(const FlowGraph &Graph,
                              std::vector<unsigned> Roots) {
  std::vector<bool> Seen(Graph.size());
  while (!Roots.empty()) {
    unsigned N = Roots.back();
    Roots.pop_back();
    if (Seen[N])
      continue;
    Seen[N] = true;
    Roots.insert(Roots.end(), Graph[N].begin(), Graph[N].end());
  }
  return Seen;
}

namespace {

constexpr unsigned None = ~0U;

FlowGraph reversed(const FlowGraph &Graph) {
  FlowGraph Preds(Graph.size());
  for (unsigned N = 0; N < Graph.size(); ++N)
    for (unsigned S : Graph[N])
      Preds[S].push_back(N);
  return Preds;
}

/// The nodes of the loop without an exit that \p Node ends up in.
std::vector<bool> endlessLoop(const FlowGraph &Graph, const FlowGraph &Preds,
                              unsigned Node) {
  for (;;) {
    std::vector<bool> Loop = reachedFrom(Graph, {Node});
    std::vector<bool> Back = reachedFrom(Preds, {Node});
    unsigned Behind = 0;
    while (Behind < Graph.size() && (!Loop[Behind] || Back[Behind]))
      ++Behind;
    if (Behind == Graph.size())
      return Loop;
    Node = Behind;
  }
}

/// Gives each endless loop an exit between two rounds. An exit inside of a
/// round would make other nodes of the loop depend on the branches that lead to
/// it. The added nodes follow those of \p Graph.
FlowGraph withEnds(FlowGraph Graph) {
  for (;;) {
    FlowGraph Preds = reversed(Graph);
    std::vector<unsigned> Ends;
    for (unsigned N = 0; N < Graph.size(); ++N)
      if (Graph[N].empty())
        Ends.push_back(N);
    std::vector<bool> Ending = reachedFrom(Preds, Ends);
    auto Stuck = std::find(Ending.begin(), Ending.end(), false);
    if (Stuck == Ending.end())
      return Graph;
    std::vector<bool> Loop = endlessLoop(
        Graph, Preds, static_cast<unsigned>(Stuck - Ending.begin()));
    auto IsEntered = [&](unsigned N) {
      return Loop[N] && std::any_of(Preds[N].begin(), Preds[N].end(),
                                    [&](unsigned P) { return !Loop[P]; });
    };
    unsigned First = 0;
    while (First < Graph.size() && !IsEntered(First))
      ++First;
    if (First == Graph.size()) // not reachable
      First = static_cast<unsigned>(std::find(Loop.begin(), Loop.end(), true) -
                                    Loop.begin());
    unsigned Again = static_cast<unsigned>(Graph.size());
    for (unsigned P : Preds[First])
      if (Loop[P])
        std::replace(Graph[P].begin(), Graph[P].end(), First, Again);
    Graph.push_back({First, Again + 1});
    Graph.push_back({});
  }
}

/// The reversed graph with one more node: the exit. Every node can be reached
/// from the exit.
class ReverseGraph {
public:
  explicit ReverseGraph(const FlowGraph &Graph);

  /// Immediate post-dominator of each node; None for the exit.
  std::vector<unsigned> postDominators() const;

  unsigned exit() const { return static_cast<unsigned>(Preds.size()) - 1; }
  const FlowGraph &successors() const { return Succs; }

private:
  void addExit(unsigned Node);
  std::vector<unsigned> postOrder() const;

  FlowGraph Succs; ///< in the original direction, including edges to the exit
  FlowGraph Preds;
};

/// Nodes of \p Graph in post-order, from each of \p Roots in turn.
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
  for (unsigned N = 0; N < Graph.size(); ++N)
    for (unsigned S : Graph[N])
      Preds[S].push_back(N);
  for (unsigned N = 0; N < Graph.size(); ++N)
    if (Graph[N].empty())
      addExit(N);
}

void ReverseGraph::addExit(unsigned Node) {
  Succs[Node].push_back(exit());
  Preds[exit()].push_back(Node);
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
  ReverseGraph Reverse(withEnds(Graph));
  std::vector<unsigned> Idom = Reverse.postDominators();
  std::vector<std::vector<unsigned>> Controllers(Reverse.successors().size());
  if (Idom.empty()) {
    Controllers.resize(Graph.size());
    return Controllers;
  }
  for (unsigned Branch = 0; Branch < Graph.size(); ++Branch) {
    const std::vector<unsigned> &Succs = Reverse.successors()[Branch];
    if (Succs.size() < 2 || Budget::isSpent())
      continue;
    for (unsigned S : Succs)
      for (unsigned N = S; N != Idom[Branch] && N != Reverse.exit();
           N = Idom[N])
        Controllers[N].push_back(Branch);
  }
  Controllers.resize(Graph.size());
  for (std::vector<unsigned> &List : Controllers) {
    std::sort(List.begin(), List.end());
    List.erase(std::unique(List.begin(), List.end()), List.end());
  }
  return Controllers;
}

} // namespace tpc
