//===- BlindSpots.cpp -----------------------------------------------------===//
#include "BlindSpots.h"
#include "Texts.h"

#include "llvm/IR/IntrinsicInst.h"

using namespace llvm;

namespace tpc {

StringRef BlindSpot::kindName() const {
  static constexpr StringRef Names[] = {
      "lost_value",   "lost_outcome", "unknown_pointer", "many_targets",
      "unread",       "dynamic_name", "outside_sources", "without_debug_info",
      "indirect_call"};
  return Names[Kind];
}

/// Why a value is not followed beyond \p I.
static std::string whyLost(const Instruction &I) {
  const auto *Call = dyn_cast<CallBase>(&I);
  if (Call && !isMultiplyAdd(I))
    return "handed to " + Wording::callee(*Call) + ", which is not looked into";
  if (Call || isa<BinaryOperator>(I))
    return "mixed with another variable";
  if (isa<GetElementPtrInst>(I))
    return "used as an index";
  return std::string("used by an operation that is not followed (") +
         I.getOpcodeName() + ")";
}

static BlindSpot spotOf(const ValueEnd &E, const ParameterRead &Read,
                        Wording &Words) {
  auto Target = [&] {
    const auto *Store = dyn_cast<StoreInst>(E.At);
    return Words.variable(Store ? Store->getPointerOperand() : Read.Target);
  };
  switch (E.Kind) {
  case ValueEnd::Mixed:
    return {BlindSpot::LostValue, E.At, Read.Name, whyLost(*E.At)};
  case ValueEnd::NoNumber:
    return {BlindSpot::LostValue, E.At, Read.Name,
            (Read.Type.empty() ? "a value of unknown type" : Read.Type) +
                " is not followed"};
  case ValueEnd::Outcome:
    return {BlindSpot::LostOutcome, E.At, Read.Name, whyLost(*E.At)};
  case ValueEnd::UnknownPointer:
    return {BlindSpot::UnknownPointer, E.At, Read.Name,
            "stored through a pointer to nowhere known"};
  case ValueEnd::ManyTargets:
    return {BlindSpot::ManyTargets, E.At, Read.Name,
            "stored to one of very many variables"};
  case ValueEnd::Unread:
    return {BlindSpot::Unread, E.At, Read.Name,
            Wording::with("stored", "into", Target()) +
                ", and nothing here reads it"};
  }
  llvm_unreachable("no such kind");
}

static void addComparisons(const GatheredResults &Gathered,
                           const ParamCallFinder::Result &Reads,
                           std::vector<BlindSpot> &Out) {
  for (const NotReported &N : Gathered.Others) {
    const std::string &Name = Reads[N.Compared->Read].Name;
    if (N.Why == NotReported::OutsideSources)
      Out.push_back({BlindSpot::OutsideSources, &N.Compared->place(), Name,
                     "compared in code that is not yours"});
    else if (N.Why == NotReported::WithoutDebugInfo)
      Out.push_back({BlindSpot::WithoutDebugInfo, &N.Compared->place(), Name,
                     "compared in code without debug information"});
    else if (N.Why == NotReported::Measured)
      Out.push_back({BlindSpot::LostValue, &N.Compared->place(), Name,
                     "one of the values that are compared with a threshold"});
  }
}

/// Library code calls through pointers of its own all the time; what the user
/// has it call goes through an `operator()`, and is where the user calls that.
static void addIndirectCalls(const CallGraphResult &Calls, Wording &Words,
                             std::vector<BlindSpot> &Out) {
  auto Add = [&](const CallBase *Call) {
    const DILocation *Place = Words.userPlace(*Call);
    if (Place && Place == Call->getDebugLoc().get())
      Out.push_back({BlindSpot::IndirectCall, Call, "",
                     "calls a function that is not known"});
  };
  for (const CallBase *Call : Calls.unresolved()) {
    const Function *F = Call->getFunction();
    if (const DISubprogram *SP = F->getSubprogram();
        SP && SP->getName() == "operator()" && !Words.userPlace(*Call))
      for_each(Calls.callers(F), Add);
    else
      Add(Call);
  }
}

std::vector<BlindSpot> findBlindSpots(const ParameterUsage &Usage,
                                      const ParamCallFinder::Result &Reads,
                                      const GatheredResults &Gathered,
                                      const CallGraphResult &Calls,
                                      Wording &Words) {
  std::vector<BlindSpot> All;
  for (const ValueEnd &E : Usage.Ends)
    All.push_back(spotOf(E, Reads[E.Read], Words));
  for (const ParameterRead &R : Reads)
    if (isDynamic(R.Name))
      All.push_back({BlindSpot::DynamicName, R.Call, "",
                     "reads a parameter whose name is put together"});
  addComparisons(Gathered, Reads, All);
  addIndirectCalls(Calls, Words, All);
  return All;
}

} // namespace tpc
