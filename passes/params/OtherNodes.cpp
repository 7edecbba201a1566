//===- OtherNodes.cpp -----------------------------------------------------===//
#include "params/OtherNodes.h"

#include "params/Texts.h"
#include "support/Names.h"

#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

/// `node` from `/ns/node`.
static StringRef withoutNamespace(StringRef Name) {
  return Name.drop_front(Name.rfind('/') + 1);
}

const StringSet<> &OtherNodes::ownNames() {
  if (Own)
    return *Own;
  Own.emplace();
  StringSet<> Constructors;
  for (StringRef Class : Tables.nodeClasses())
    Constructors.insert((Class + "::" + unscoped(Class)).str());
  for (const Function &F : M) {
    if (!Constructors.contains(Tables.match(F).Name))
      continue;
    const SmallVector<std::string, 4> Types = parameterTypes(F);
    if (Types.empty() || plainType(Types.front()) != "std::string")
      continue;
    const unsigned First = F.arg_size() - Types.size();
    for (const User *U : F.users())
      if (const auto *Call = dyn_cast<CallBase>(U);
          Call && Call->getCalledFunction() == &F)
        Own->insert(
            withoutNamespace(Known.textAt(Call->getArgOperand(First), *Call)));
  }
  return *Own;
}

bool OtherNodes::have(const CallBase &Call, const Rule &Row) {
  const Value *Node = argument(Call, Row, Row.Node);
  const std::string Name = Node ? Known.textAt(Node, Call) : "";
  return !Name.empty() && !isDynamic(Name) &&
         !ownNames().contains(withoutNamespace(Name));
}

} // namespace tpc
