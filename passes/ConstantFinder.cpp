//===- ConstantFinder.cpp -------------------------------------------------===//
#include "ConstantFinder.h"

#include "IfStatements.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

/// True where \p V is a truth value, be it as an integer.
static bool isTruth(const Value *V) {
  for (unsigned Steps = 0; Steps < 8; ++Steps) {
    if (V->getType()->isIntegerTy(1))
      return true;
    const auto *I = dyn_cast<Instruction>(V);
    const auto *Expect = dyn_cast<IntrinsicInst>(V);
    if (!I || !(isa<ZExtInst>(I) || I->isBitwiseLogicOp() ||
                (Expect && Expect->getIntrinsicID() == Intrinsic::expect)))
      return false;
    V = I->getOperand(
        I->isBitwiseLogicOp() && isa<Constant>(I->getOperand(0)) ? 1 : 0);
  }
  return false;
}

/// The number that \p V is: a constant, or what is in a constant global.
static const Constant *numberOf(const Value *V) {
  while (const auto *Cast = dyn_cast<CastInst>(V))
    V = Cast->getOperand(0);
  if (const auto *Load = dyn_cast<LoadInst>(V))
    if (const auto *Global =
            dyn_cast<GlobalVariable>(Load->getPointerOperand());
        Global && Global->isConstant() && Global->hasDefinitiveInitializer())
      V = Global->getInitializer();
  return isa<ConstantInt>(V) || isa<ConstantFP>(V) ? cast<Constant>(V)
                                                   : nullptr;
}

/// The name of the variable, or the number as text.
static std::string nameOf(const Value *V, bool Unsigned) {
  while (const auto *Cast = dyn_cast<CastInst>(V))
    V = Cast->getOperand(0);
  if (const auto *Load = dyn_cast<LoadInst>(V)) {
    SmallVector<DIGlobalVariableExpression *, 1> Infos;
    cast<GlobalVariable>(Load->getPointerOperand())->getDebugInfo(Infos);
    if (!Infos.empty())
      return Infos.front()->getVariable()->getName().str();
  }
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

/// True where \p Compare only asks for a number other than zero: what clang
/// makes of a number that stands as a condition as well.
static bool asksForNonZero(const CmpInst &Compare) {
  const auto *Zero = dyn_cast<Constant>(Compare.getOperand(1));
  return Zero && Zero->isZeroValue() &&
         (Compare.getPredicate() == CmpInst::ICMP_NE ||
          Compare.getPredicate() == CmpInst::FCMP_UNE);
}

void ConstantFinder::compared(CmpInst &Compare, Instruction &Predicate,
                              const SliceEntry &E, bool Direct) {
  unsigned Threshold = numberOf(Compare.getOperand(1)) ? 1 : 0;
  const Value *Other = Compare.getOperand(1 - Threshold);
  if (!numberOf(Compare.getOperand(Threshold)) || numberOf(Other) ||
      isTruth(Other) || asksForNonZero(Compare))
    return;
  auto Known = Found.find(&Compare);
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

/// Goes back from what \p Predicate decides by.
void ConstantFinder::decide(Instruction &Predicate, const SliceEntry &E) {
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
      compared(*Compare, Predicate, E, It.Direct);
      // Of truth values the comparisons that they came from.
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
      decide(*Predicate, *E);
  std::vector<Comparison> All;
  for (auto &[Compare, C] : Found)
    All.push_back(std::move(C));
  return All;
}

} // namespace tpc
