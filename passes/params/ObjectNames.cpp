//===- ObjectNames.cpp ----------------------------------------------------===//
#include "params/ObjectNames.h"

#include "params/Callbacks.h"
#include "params/Idioms.h"
#include "params/OtherNodes.h"
#include "params/Texts.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

ObjectNames::ObjectNames(Module &M, ModuleAnalysisManager &AM, Texts &Known)
    : Rules(AM.getResult<RuleAnalysis>(M)),
      Calls(AM.getResult<SimpleCallGraph>(M)), Known(Known),
      Sources(AM.getResult<OptionsAnalysis>(M)) {
  forEachCall(M, Rules, Rule::Identity, [&](CallBase &Call, const Rule &) {
    Identities.push_back(&Call);
  });
  OtherNodes Others(M, AM, Known);
  forEachCall(M, Rules, Rule::Callback, [&](CallBase &Call, const Rule &Row) {
    if (!Row.Name)
      return;
    std::string Name =
        Others.have(Call, Row) ? std::string() : Known.nameOf(Call, Row);
    for (unsigned N : Row.Callbacks)
      if (const Value *Argument = argument(Call, Row, N))
        for (const Function *F : calledBackBy(*Argument, Call, Sources)) {
          auto [It, New] = CalledFor.try_emplace(F, Name);
          if (New || Name.empty() || It->second == Name)
            continue;
          It->second = It->second.empty() ? Name : DynamicName;
        }
  });
}

/// Adds the text that \p Test, described by \p Row, compares \p Name with, if
/// \p At is only reached where the two are equal.
void ObjectNames::addTest(const CallBase &Test, const Rule &Row,
                          const Value *Name, const CallBase &At,
                          std::set<std::string> &Out) {
  bool IsEqual = Row.Relation == "==";
  if ((!IsEqual && Row.Relation != "!=") || Test.arg_size() != 2 ||
      Test.getFunction() != At.getFunction())
    return;
  const Value *Other =
      Test.getArgOperand(Test.getArgOperand(0) == Name ? 1 : 0);
  auto [It, New] = Trees.try_emplace(At.getFunction());
  if (New)
    It->second.recalculate(const_cast<Function &>(*At.getFunction()));
  for (const User *U : Test.users()) {
    const auto *Branch = dyn_cast<BranchInst>(U);
    if (!Branch || !Branch->isConditional())
      continue;
    BasicBlockEdge Taken(Branch->getParent(),
                         Branch->getSuccessor(IsEqual ? 0 : 1));
    if (It->second.dominates(Taken, At.getParent()))
      Out.insert(Known.textAt(Other, Test));
  }
}

std::set<std::string> ObjectNames::testedOn(const CallBase &At,
                                            const Value *Object) {
  std::set<std::string> Found;
  for (const CallBase *Identity : Identities) {
    const Rule *Row = Rules.match(*Identity);
    const Value *Of = objectOf(*Identity, *Row);
    if (Identity->getFunction() != At.getFunction() || !Of ||
        !isSameVariable(Of, Object))
      continue;
    // The name itself, and the strings that are copies of it.
    SmallVector<const Value *, 2> Names{Identity};
    if (Identity->hasStructRetAttr())
      Names.front() = Identity->getArgOperand(0);
    for (unsigned N = 0; N < Names.size(); ++N)
      for (const User *U : Names[N]->users()) {
        const auto *Call = dyn_cast<CallBase>(U);
        const Rule *Does = Call ? Rules.match(*Call) : nullptr;
        if (!Does || Does->Kind != Rule::Text)
          continue;
        if (Does->Relation != "copy")
          addTest(*Call, *Does, Names[N], At, Found);
        else if (N == 0 && Call->arg_size() > 1 &&
                 Call->getArgOperand(1) == Names[N])
          Names.push_back(Call->getArgOperand(0));
      }
  }
  return Found;
}

std::set<std::string> ObjectNames::givenTo(const Argument &Given) {
  std::set<std::string> Found;
  bool IsOfOthers = false;
  SmallSetVector<const Argument *, 4> Work;
  Work.insert(&Given);
  for (unsigned N = 0; N < Work.size(); ++N) {
    const Function &F = *Work[N]->getParent();
    const unsigned Number = Work[N]->getArgNo();
    if (auto Called = CalledFor.find(&F); Called != CalledFor.end()) {
      if (Called->second.empty())
        IsOfOthers = true;
      else
        Found.insert(Called->second);
    }
    for (const CallBase *Call : Calls.callers(&F)) {
      if (!Sources.has(*Call->getFunction()) || Number >= Call->arg_size())
        continue;
      const Value *Object = Call->getArgOperand(Number);
      std::set<std::string> Names = testedOn(*Call, Object);
      Found.insert(Names.begin(), Names.end());
      if (!Names.empty())
        continue;
      if (const auto *Further = dyn_cast<Argument>(Object))
        Work.insert(Further);
      else
        Found.insert(DynamicName);
    }
  }
  if (Found.empty() && !IsOfOthers)
    Found.insert(DynamicName);
  return Found;
}

} // namespace tpc
