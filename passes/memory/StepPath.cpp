//===- StepPath.cpp -------------------------------------------------------===//
#include "memory/StepPath.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/Support/Allocator.h"

#include <tuple>

using namespace llvm;

namespace tpc {

/// All paths. They are kept until the thread ends: they are small, and
/// locations are copied too often to count references.
class StepPath::Store {
public:
  const Node *inner(const Node *Outer, const Step &S) {
    unsigned From = Outer ? Outer->Number : 0;
    const Node *&Known = Nodes[{From, S.Type, S.Index, S.Class, S.Item.Number}];
    if (Known)
      return Known;
    size_t Size = Outer ? Outer->Steps.size() : 0;
    Step *Steps = Memory.Allocate<Step>(Size + 1);
    if (Outer)
      std::uninitialized_copy(Outer->Steps.begin(), Outer->Steps.end(), Steps);
    new (Steps + Size) Step(S);
    unsigned &Shape = Shapes[{Outer ? Outer->Shape : 0, S.Type, S.Index}];
    if (!Shape)
      Shape = Shapes.size();
    unsigned Number = Nodes.size();
    Known = new (Memory.Allocate<Node>())
        Node{ArrayRef(Steps, Size + 1), Outer, Number, Shape};
    return Known;
  }

private:
  BumpPtrAllocator Memory;
  /// By the number of the outer path (0 for none) and the step.
  DenseMap<std::tuple<unsigned, unsigned, unsigned, unsigned, unsigned>,
           const Node *>
      Nodes;
  /// By the shape of the outer path (0 for none), the class and the field.
  DenseMap<std::tuple<unsigned, unsigned, unsigned>, unsigned> Shapes;
};

const StepPath::Node *StepPath::inner(const Node *Outer, const Step &S) {
  static thread_local Store All;
  return All.inner(Outer, S);
}

bool endsWith(ArrayRef<Step> Path, ArrayRef<Step> Tail) {
  if (Tail.size() > Path.size())
    return false;
  // Most paths already differ in their last steps.
  for (size_t N = 1; N <= Tail.size(); ++N)
    if (!Tail[Tail.size() - N].mayEqual(Path[Path.size() - N]))
      return false;
  return true;
}

} // namespace tpc
