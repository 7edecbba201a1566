//===- Wording.cpp --------------------------------------------------------===//
#include "results/Wording.h"

#include "support/Names.h"

#include "llvm/ADT/SmallString.h"

using namespace llvm;

namespace tpc {

Wording::Wording(const LocationTypes &Types, PointsTo &Pointers,
                 const ExternCallFinder::Result &Exposing, const Options &Opts)
    : Pointers(Pointers), Sources(Opts), Names(Types) {
  for (const ExposingStatement &E : Exposing)
    if (E.IsCall)
      this->Exposing[E.At] = &E;
}

const DILocation *Wording::userPlace(const Instruction &I) {
  const DILocation *Loc = I.getDebugLoc();
  while (Loc && (Loc->getLine() == 0 || !Sources.has(Loc)))
    Loc = Loc->getInlinedAt();
  return Loc;
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
  return Names.nameOf(V, Pointers);
}

std::string Wording::exposed(const ExposingStatement &E) const {
  if (!E.IsCall)
    return "given back by " + E.Topic;
  StringRef Name = unscoped(E.Api);
  std::string Text = Name == "publish" ? "published"
                     : Name == "call"  ? "service called"
                                       : (Name + "()").str();
  return E.Topic.empty() ? Text : Text + " on " + E.Topic;
}

std::string Wording::guarded(const Instruction &I) {
  if (const ExposingStatement *E = Exposing.lookup(&I)) {
    std::string Text = (unscoped(E->Api) + "()").str();
    return E->Topic.empty() ? Text : Text + " on " + E->Topic;
  }
  if (const auto *Call = dyn_cast<CallBase>(&I))
    return "the call of " + calleeName(*Call);
  if (const auto *Store = dyn_cast<StoreInst>(&I))
    if (std::string Name = variable(Store->getPointerOperand()); !Name.empty())
      return "the store to " + Name;
  if (isa<ReturnInst>(I))
    return "what " + shortName(*I.getFunction()) + " returns";
  const DILocation *Loc = userPlace(I);
  return Loc ? "line " + std::to_string(Loc->getLine()) : "";
}

} // namespace tpc
