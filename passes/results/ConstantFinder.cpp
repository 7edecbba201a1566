//===- ConstantFinder.cpp -------------------------------------------------===//
#include "results/ConstantFinder.h"

#include "control/IfStatements.h"
#include "memory/Variables.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

/// True if \p V is a truth value, also one stored as an integer.
static bool isTruth(const Value *V) {
  for (unsigned Steps = 0; Steps < 8; ++Steps) {
    if (V->getType()->isIntegerTy(1))
      return true;
    const auto *I = dyn_cast<Instruction>(V);
    const auto *Expect = dyn_cast<IntrinsicInst>(V);
    if (!I || !(isa<ZExtInst>(I) || I->isBitwiseLogicOp() ||
                (Expect && Expect->getIntrinsicID() == Intrinsic::expect)))
      return false;
    // One of the two operands may be a constant mask, but not both.
    bool Second = I->isBitwiseLogicOp() && isa<Constant>(I->getOperand(0));
    V = I->getOperand(Second ? 1 : 0);
  }
  return false;
}

/// \p V before conversions.
static const Value *unconverted(const Value *V) {
  while (const auto *Cast = dyn_cast<CastInst>(V))
    V = Cast->getOperand(0);
  return V;
}

/// The constant global that \p Load reads; null if it reads something else.
static const GlobalVariable *constantGlobal(const LoadInst &Load) {
  const auto *Global = dyn_cast<GlobalVariable>(Load.getPointerOperand());
  return Global && Global->isConstant() && Global->hasDefinitiveInitializer()
             ? Global
             : nullptr;
}

/// The number that \p V is, or that a constant global holds.
static const Constant *plainNumber(const Value *V) {
  V = unconverted(V);
  if (const auto *Load = dyn_cast<LoadInst>(V))
    if (const GlobalVariable *Global = constantGlobal(*Load))
      V = Global->getInitializer();
  return isa<ConstantInt>(V) || isa<ConstantFP>(V) ? cast<Constant>(V)
                                                   : nullptr;
}

/// The number that every function that \p Call can enter returns; null if there
/// is none.
const Constant *ConstantFinder::returnedBy(const CallBase &Call) const {
  const Constant *Only = nullptr;
  for (const Function *Callee : Calls.callees(Call))
    for (const BasicBlock &BB : *Callee)
      if (const auto *Return = dyn_cast<ReturnInst>(BB.getTerminator())) {
        const Value *V = Return->getReturnValue();
        const Constant *C = V ? plainNumber(V) : nullptr;
        if (!C || (Only && Only != C))
          return nullptr;
        Only = C;
      }
  return Only;
}

/// The number that \p Load reads if it reads a const member to which all
/// constructors give the same value; otherwise null.
const Constant *ConstantFinder::ofConstMember(const LoadInst &Load) const {
  Locations Where = Pointers.touched(Load);
  if (Where.empty() || !all_of(Where, [&](const Location &L) {
        return !L.Path.empty() && L.Path.back().isField() &&
               Types.isConst(L.Path.back());
      }))
    return nullptr;
  const Constant *Only = nullptr;
  for (const Instruction *Write : Writes.definitionsOf(Load)) {
    const auto *Store = dyn_cast<StoreInst>(Write);
    const Constant *C = Store ? plainNumber(Store->getValueOperand()) : nullptr;
    if (!C || (Only && Only != C))
      return nullptr;
    Only = C;
  }
  return Only;
}

/// The number that \p V is: a constant, the value of a constant global or
/// member, or what a function always returns.
const Constant *ConstantFinder::numberOf(const Value *V) const {
  if (const Constant *C = plainNumber(V))
    return C;
  V = unconverted(V);
  if (const auto *Call = dyn_cast<CallBase>(V))
    return returnedBy(*Call);
  const auto *Load = dyn_cast<LoadInst>(V);
  return Load ? ofConstMember(*Load) : nullptr;
}

/// The name of the variable or function; otherwise the number as text.
std::string ConstantFinder::nameOf(const Value *V, bool Unsigned) const {
  const Value *Source = unconverted(V);
  if (const auto *Load = dyn_cast<LoadInst>(Source)) {
    SmallVector<DIGlobalVariableExpression *, 1> Infos;
    if (const GlobalVariable *Global = constantGlobal(*Load))
      Global->getDebugInfo(Infos);
    if (!Infos.empty())
      return Infos.front()->getVariable()->getName().str();
    VariableNames Names(Types);
    for (const Location &L : Pointers.touched(*Load))
      if (std::string Name = Names.nameOf(L); !Name.empty())
        return Name;
  }
  if (const auto *Call = dyn_cast<CallBase>(Source); Call && !plainNumber(V))
    return calleeName(*Call);
  const Constant *C = numberOf(V);
  if (const auto *Int = dyn_cast<ConstantInt>(C)) {
    SmallString<24> Text;
    Int->getValue().toString(Text, 10, !Unsigned);
    return Text.str().str();
  }
  if (auto Number = constantNumber(C))
    return shortest(*Number);
  return cast<ConstantFP>(C)->getValueAPF().isNaN() ? "nan" : "inf";
}

/// True if \p Compare only asks whether a number is not zero, which is also
/// what clang generates for a number used as a condition.
static bool asksForNonZero(const CmpInst &Compare) {
  const auto *Zero = dyn_cast<Constant>(Compare.getOperand(1));
  return Zero && Zero->isZeroValue() &&
         (Compare.getPredicate() == CmpInst::ICMP_NE ||
          Compare.getPredicate() == CmpInst::FCMP_UNE);
}

void ConstantFinder::addComparison(CmpInst &Compare, Instruction &Predicate,
                                   const SliceEntry &E, bool Direct) {
  // A literal number is preferred to one that must be searched for.
  unsigned Threshold = plainNumber(Compare.getOperand(1))   ? 1
                       : plainNumber(Compare.getOperand(0)) ? 0
                       : numberOf(Compare.getOperand(1))    ? 1
                                                            : 0;
  const Value *Other = Compare.getOperand(1 - Threshold);
  if (!numberOf(Compare.getOperand(Threshold)) || plainNumber(Other) ||
      isTruth(Other) || asksForNonZero(Compare) || !comparesValues(Compare))
    return;
  auto *Known = Found.find(&Compare);
  if (Known != Found.end() && Known->second.Slice.Distance <= E.Distance)
    return;
  const DILocation *Place = Where(Compare);
  if (!Place)
    return;
  Comparison C{};
  C.Type = Comparison::Constant;
  C.Compare = &Compare;
  C.Threshold = Threshold;
  C.Predicate = &Predicate;
  C.Direct = Direct;
  C.Slice = E;
  C.Where = Place;
  C.ConstantName = nameOf(Compare.getOperand(Threshold), Compare.isUnsigned());
  Found[&Compare] = std::move(C);
}

/// Searches backward from the value that \p Predicate tests.
void ConstantFinder::searchBack(Instruction &Predicate, const SliceEntry &E) {
  struct Item {
    Value *V;
    bool Direct;
  };
  SmallVector<Item, 8> Work{{conditionOf(Predicate), true}};
  SmallPtrSet<const Value *, 8> Seen;
  while (!Work.empty()) {
    Item It = Work.pop_back_val();
    auto *I = dyn_cast<Instruction>(It.V);
    if (!I || !Seen.insert(I).second)
      continue;
    if (auto *Compare = dyn_cast<CmpInst>(I)) {
      addComparison(*Compare, Predicate, E, It.Direct);
      // For truth values, the comparisons that they came from.
      for (Value *Operand : Compare->operands())
        if (isTruth(Operand))
          Work.push_back({Operand, It.Direct});
    } else if (isa<CastInst>(I) || isa<FreezeInst>(I) ||
               I->isBitwiseLogicOp()) {
      for (Value *Operand : I->operands())
        Work.push_back({Operand, It.Direct});
    } else if (auto *Phi = dyn_cast<PHINode>(I)) {
      for (Value *In : Phi->incoming_values())
        Work.push_back({In, false});
    } else if (auto *Expect = dyn_cast<IntrinsicInst>(I);
               Expect && Expect->getIntrinsicID() == Intrinsic::expect) {
      Work.push_back({Expect->getArgOperand(0), It.Direct});
    } else if (auto *Call = dyn_cast<CallBase>(I)) {
      if (!I->getType()->isIntegerTy(1))
        continue;
      for (Function *Callee : Calls.callees(*Call))
        for (BasicBlock &BB : *Callee)
          if (auto *Return = dyn_cast<ReturnInst>(BB.getTerminator()))
            Work.push_back({Return->getReturnValue(), false});
    }
  }
}

std::vector<Comparison>
ConstantFinder::run(ArrayRef<Instruction *> Predicates) {
  for (Instruction *Predicate : Predicates)
    if (std::optional<SliceEntry> E = Slice.lookup(Predicate))
      searchBack(*Predicate, *E);
  std::vector<Comparison> All;
  for (auto &[Compare, C] : Found)
    All.push_back(std::move(C));
  return All;
}

} // namespace tpc
