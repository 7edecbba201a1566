//===- Wording.cpp --------------------------------------------------------===//
#include "results/Wording.h"

#include "support/Compat.h"
#include "support/Names.h"

#include "llvm/ADT/SmallString.h"
#include "llvm/IR/IntrinsicInst.h"

using namespace llvm;

namespace tpc {

Wording::Wording(const LocationTypes &Types, PointsTo &Pointers,
                 const ExternCallFinder::Result &Exposing, const Options &Opts)
    : Pointers(Pointers), Sources(Opts), Names(Types) {
  for (const ExposingStatement &E : Exposing)
    this->Exposing[E.Call] = &E;
}

const DILocation *Wording::userPlace(const Instruction &I) {
  const DILocation *Loc = I.getDebugLoc();
  while (Loc && (Loc->getLine() == 0 || !Sources.has(Loc)))
    Loc = Loc->getInlinedAt();
  return Loc;
}

bool isMultiplyAdd(const Instruction &I) {
  const auto *Call = dyn_cast<IntrinsicInst>(&I);
  return Call && (Call->getIntrinsicID() == Intrinsic::fmuladd ||
                  Call->getIntrinsicID() == Intrinsic::fma);
}

/// The last part of a name with scopes.
static StringRef lastPart(StringRef Name) {
  size_t Scope = Name.rfind("::");
  return Scope == StringRef::npos ? Name : Name.drop_front(Scope + 2);
}

std::string Wording::function(const Function &F) {
  // The debug information keeps the name of the function that was cloned.
  const DISubprogram *SP = F.getSubprogram();
  StringRef Linkage = SP ? SP->getLinkageName() : "";
  return lastPart(qualifiedName(Linkage.empty() ? F.getName() : Linkage))
             .str() +
         "()";
}

std::string Wording::callee(const CallBase &Call) {
  const Function *F = Call.getCalledFunction();
  if (!F)
    return "a function that is not known";
  StringRef Name = F->getName();
  if (!Name.consume_front("llvm."))
    return function(*F);
  // The source calls `llvm.fabs.f64` fabs().
  return Name.split('.').first.str() + "()";
}

std::string Wording::nameOf(const Value *Pointer, bool Scalar) const {
  for (const Location &L : Pointers.resolve(Pointer, Scalar))
    if (std::string Name = Names.fullNameOf(L); !Name.empty())
      return Name;
  return "";
}

std::string Wording::with(const std::string &Before, StringRef Preposition,
                          const std::string &Name) {
  return Name.empty() ? Before
                      : (Before + " " + Preposition + " " + Name).str();
}

std::string Wording::variable(const Value *Pointer) const {
  return nameOf(Pointer, /*Scalar=*/true);
}

std::string Wording::object(const Value *Pointer) const {
  return nameOf(Pointer, /*Scalar=*/false);
}

/// The name of \p V, a local variable or argument of its function \p F.
static std::string localName(const Value &V, const Function &F) {
  for (const DbgVariableRecord *R : variableRecords(const_cast<Value *>(&V)))
    if (R->getVariable()->getScope()->getSubprogram() == F.getSubprogram())
      return R->getVariable()->getName().str();
  return "";
}

std::string Wording::argument(const Argument &Arg) const {
  return localName(Arg, *Arg.getParent());
}

static std::string constantText(const Constant &C) {
  SmallString<16> Text;
  if (const auto *Int = dyn_cast<ConstantInt>(&C))
    Int->getValue().toString(Text, 10, /*Signed=*/!C.getType()->isIntegerTy(8));
  else if (const auto *Float = dyn_cast<ConstantFP>(&C))
    Float->getValueAPF().toString(Text, /*FormatPrecision=*/6);
  return std::string(Text);
}

std::string Wording::value(const Value *V) const {
  while (const auto *Cast = dyn_cast<CastInst>(V))
    V = Cast->getOperand(0);
  if (const auto *C = dyn_cast<Constant>(V))
    return constantText(*C);
  if (const auto *Arg = dyn_cast<Argument>(V))
    return argument(*Arg);
  const auto *I = dyn_cast<Instruction>(V);
  if (!I)
    return "";
  if (std::string Name = localName(*V, *I->getFunction()); !Name.empty())
    return Name;
  const auto *Load = dyn_cast<LoadInst>(V);
  if (const auto *Reference =
          Load ? dyn_cast<Argument>(Load->getPointerOperand()) : nullptr)
    if (std::string Name = argument(*Reference); !Name.empty())
      return Name;
  if (Load)
    for (const Location &L : Pointers.resolve(Load->getPointerOperand(), true))
      if (std::string Name = Names.nameOf(L); !Name.empty())
        return Name;
  const auto *Call = dyn_cast<CallBase>(V);
  return Call && Call->getCalledFunction() && !isMultiplyAdd(*Call)
             ? callee(*Call)
             : "";
}

std::string Wording::exposed(const ExposingStatement &E) const {
  StringRef Name = lastPart(E.Row->Function);
  std::string Text = Name == "publish" ? "published"
                     : Name == "call"  ? "service called"
                                       : (Name + "()").str();
  return E.Topic.empty() ? Text : Text + " on " + E.Topic;
}

std::string Wording::guarded(const Instruction &I) {
  if (const ExposingStatement *E = Exposing.lookup(&I)) {
    std::string Text = (lastPart(E->Row->Function) + "()").str();
    return E->Topic.empty() ? Text : Text + " on " + E->Topic;
  }
  if (const auto *Call = dyn_cast<CallBase>(&I))
    return "the call of " + callee(*Call);
  if (const auto *Store = dyn_cast<StoreInst>(&I))
    if (std::string Name = variable(Store->getPointerOperand()); !Name.empty())
      return "the store to " + Name;
  if (isa<ReturnInst>(I))
    return "what " + function(*I.getFunction()) + " returns";
  const DILocation *Loc = userPlace(I);
  return Loc ? "line " + std::to_string(Loc->getLine()) : "";
}

} // namespace tpc
