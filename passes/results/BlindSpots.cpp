//===- BlindSpots.cpp -----------------------------------------------------===//
#include "results/BlindSpots.h"
#include "params/Texts.h"
#include "support/Names.h"

#include "llvm/ADT/STLExtras.h"
#include "llvm/IR/IntrinsicInst.h"

using namespace llvm;

namespace tpc {

static constexpr StringRef KindNames[] = {
    "lost_value",   "lost_outcome", "unknown_pointer", "many_targets",
    "unread",       "dynamic_name", "outside_sources", "without_debug_info",
    "indirect_call"};

StringRef BlindSpot::kindName() const { return KindNames[Kind]; }

unsigned BlindSpot::rankOf(StringRef Name) {
  const auto *Known = find(KindNames, Name);
  return Known == std::end(KindNames) ? 0 : Known - std::begin(KindNames);
}

/// Why a value is not followed beyond \p I.
static std::string whyLost(const Instruction &I) {
  const auto *Call = dyn_cast<CallBase>(&I);
  if (Call && !isMultiplyAdd(I))
    return "handed to " + calleeName(*Call) + ", which is not analysed";
  if (Call || isa<BinaryOperator>(I))
    return "mixed with another variable";
  if (isa<GetElementPtrInst>(I))
    return "used as an index";
  if (isa<StoreInst>(I))
    return "added to what the variable held before";
  if (isa<CmpInst>(I) && any_of(I.operands(), IsaPred<Constant>))
    return "mixed with another variable, and compared with a constant";
  if (isa<CmpInst>(I))
    return "one of the values that are compared with a threshold";
  return std::string("used by an operation that is not followed (") +
         I.getOpcodeName() + ")";
}

static BlindSpot::KindTy kindOf(ValueEnd::KindTy Kind) {
  switch (Kind) {
  case ValueEnd::Mixed:
  case ValueEnd::NoNumber:
    return BlindSpot::LostValue;
  case ValueEnd::Outcome:
    return BlindSpot::LostOutcome;
  case ValueEnd::UnknownPointer:
    return BlindSpot::UnknownPointer;
  case ValueEnd::ManyTargets:
    return BlindSpot::ManyTargets;
  case ValueEnd::Unread:
    return BlindSpot::Unread;
  }
  llvm_unreachable("no such kind");
}

static std::optional<BlindSpot::KindTy> kindOf(NotReported::WhyTy Why) {
  switch (Why) {
  case NotReported::NotExposed:
    return std::nullopt;
  case NotReported::OutsideSources:
    return BlindSpot::OutsideSources;
  case NotReported::WithoutDebugInfo:
    return BlindSpot::WithoutDebugInfo;
  case NotReported::Measured:
    return BlindSpot::LostValue;
  }
  llvm_unreachable("no such reason");
}

std::string BlindSpot::text(const ParamCallFinder::Result &Reads,
                            const Wording &Words) const {
  switch (Kind) {
  case LostValue:
    if (IsNoNumber)
      return (Reads[Read].Type.empty() ? "a value of unknown type"
                                       : Reads[Read].Type) +
             " is not followed";
    return whyLost(*At);
  case LostOutcome:
    return whyLost(*At);
  case UnknownPointer:
    return "stored through a pointer to an unknown place";
  case ManyTargets:
    return "stored to one of very many variables";
  case Unread: {
    const auto *Store = dyn_cast<StoreInst>(At);
    const Value *Into = Store ? Store->getPointerOperand() : Reads[Read].Target;
    // A list may be the result of a call.
    if (!Into)
      return "nothing here reads it";
    return Wording::with("stored", "into", Words.variable(Into)) +
           ", and nothing here reads it";
  }
  case DynamicName:
    return "reads a parameter whose name is not constant";
  case OutsideSources:
    return "compared in code that is not yours";
  case WithoutDebugInfo:
    return "compared in code without debug information";
  case IndirectCall:
    return "calls a function that is not known";
  }
  llvm_unreachable("no such kind");
}

/// Library code often calls through its own pointers. A call of user code by a
/// library goes through an `operator()`, and is listed where the user calls
/// that.
static void addIndirectCalls(const CallGraphResult &Calls, Wording &Words,
                             std::vector<BlindSpot> &Out) {
  auto Add = [&](const CallBase *Call) {
    const DILocation *Place = Words.userPlace(*Call);
    if (Place && Place == Call->getDebugLoc().get())
      Out.push_back({BlindSpot::IndirectCall, Call});
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
  All.reserve(Usage.Ends.size());
  for (const ValueEnd &E : Usage.Ends)
    All.push_back({kindOf(E.Kind), E.At, E.Read, E.Kind == ValueEnd::NoNumber});
  for (const ParameterRead &R : Reads)
    if (isDynamic(R.Name))
      All.push_back({BlindSpot::DynamicName, R.Call});
  for (const NotReported &N : Gathered.Others)
    if (std::optional<BlindSpot::KindTy> Kind = kindOf(N.Why))
      All.push_back({*Kind, &N.Compared->place(), N.Compared->Read});
  addIndirectCalls(Calls, Words, All);
  return All;
}

} // namespace tpc
