//===- Checksum.cpp -------------------------------------------------------===//
//
// LLVM's StructuralHash leaves out types, and names of constants that a linker
// changes are in it.
//
//===----------------------------------------------------------------------===//
#include "plan/Checksum.h"

#include "support/Functions.h"
#include "support/Names.h"
#include "support/Numbers.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/StringExtras.h"
#include "llvm/Demangle/Demangle.h"
#include "llvm/IR/Constants.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/DerivedTypes.h"
#include "llvm/IR/GlobalAlias.h"
#include "llvm/IR/GlobalVariable.h"
#include "llvm/IR/InlineAsm.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Operator.h"
#include "llvm/Support/Endian.h"
#include "llvm/Support/xxhash.h"

#include <cstdlib>

using namespace llvm;

namespace tpc {

/// The name of \p V without what linking or copying put behind it.
static StringRef stableName(const GlobalValue &V) {
  StringRef Name = V.getName().split(CopyMark).first;
  if (const auto *F = dyn_cast<Function>(&V); F && F->hasFnAttribute(LocalOf))
    Name = nameInUnit(*F);
  if (!V.hasLocalLinkage())
    return Name;
  // Two local values of one name get numbers.
  while (true) {
    auto [Before, Number] = Name.rsplit('.');
    if (Before.empty() || Number.empty() ||
        Number.find_if_not(isDigit) != StringRef::npos)
      return Name;
    Name = Before;
  }
}

/// The same for all variants of a constructor or destructor: two of them are
/// mostly one function, but that is not known where it is only declared.
static std::string callableName(const GlobalValue &V) {
  StringRef Name = stableName(V);
  static constexpr StringLiteral Variants[] = {"C1E", "C2E", "D1E", "D2E"};
  if (none_of(Variants, [&](StringRef Each) { return Name.contains(Each); }))
    return Name.str();
  ItaniumPartialDemangler Demangler;
  std::string Mangled = Name.str();
  if (Demangler.partialDemangle(Mangled.c_str()) || !Demangler.isCtorOrDtor())
    return Mangled;
  char *Text = Demangler.finishDemangle(nullptr, nullptr);
  std::string Found = Text ? Text : Mangled;
  std::free(Text);
  return Found;
}

namespace {

class Sum {
public:
  explicit Sum(const Function &F) {
    for (auto [Number, I] : enumerate(numberedInstructions(F)))
      Numbers[&I] = Number;
    for (auto [Number, BB] : enumerate(F))
      Numbers[&BB] = Number;
    add(F.getFunctionType());
    for (const Instruction &I : numberedInstructions(F))
      add(I);
  }
  std::string text() const {
    return utohexstr(xxh3_64bits(ArrayRef(Bytes)), /*LowerCase=*/true,
                     /*Width=*/16);
  }

private:
  void add(uint64_t Number) {
    uint8_t Written[8];
    support::endian::write64le(Written, Number);
    Bytes.append(std::begin(Written), std::end(Written));
  }
  void add(StringRef Text) {
    add(Text.size());
    Bytes.append(Text.bytes_begin(), Text.bytes_end());
  }
  void add(const APInt &Number) {
    add(Number.getBitWidth());
    for (unsigned N = 0; N < Number.getNumWords(); ++N)
      add(Number.getRawData()[N]);
  }
  void add(const Type *T);
  void add(const Constant *C);
  void add(const GlobalValue &V);
  void add(const Value *V);
  void add(const Instruction &I);

  DenseMap<const Value *, unsigned> Numbers;
  SmallVector<uint8_t, 0> Bytes;
};

} // namespace

/// Names of types are the linker's; a pointer says nothing of its target.
void Sum::add(const Type *T) {
  add(T->getTypeID());
  if (T->isIntegerTy())
    add(T->getIntegerBitWidth());
  if (const auto *A = dyn_cast<ArrayType>(T))
    add(A->getNumElements());
  if (const auto *V = dyn_cast<VectorType>(T))
    add(V->getElementCount().getKnownMinValue());
  add(T->getNumContainedTypes());
  for (const Type *Part : T->subtypes())
    add(Part);
}

void Sum::add(const GlobalValue &V) {
  const auto *Alias = dyn_cast<GlobalAlias>(&V);
  const auto *Of = Alias ? dyn_cast<Function>(Alias->getAliasee()) : nullptr;
  add(StringRef(callableName(Of ? *Of : V)));
  // The texts of a file are numbered.
  const auto *Variable = dyn_cast<GlobalVariable>(&V);
  if (Variable && Variable->hasLocalLinkage() && Variable->hasInitializer())
    if (const auto *Data =
            dyn_cast<ConstantDataSequential>(Variable->getInitializer()))
      add(Data->getRawDataValues());
}

void Sum::add(const Constant *C) {
  if (const auto *V = dyn_cast<GlobalValue>(C))
    return add(*V);
  add(C->getValueID());
  add(C->getType());
  if (const auto *I = dyn_cast<ConstantInt>(C))
    return add(I->getValue());
  if (const auto *F = dyn_cast<ConstantFP>(C))
    return add(F->getValueAPF().bitcastToAPInt());
  if (const auto *Data = dyn_cast<ConstantDataSequential>(C))
    return add(Data->getRawDataValues());
  if (const auto *E = dyn_cast<ConstantExpr>(C))
    add(E->getOpcode());
  if (const auto *GEP = dyn_cast<GEPOperator>(C))
    add(GEP->getSourceElementType());
  for (const Use &U : C->operands())
    add(U.get());
}

void Sum::add(const Value *V) {
  if (const auto *C = dyn_cast<Constant>(V))
    return add(C);
  if (const auto *A = dyn_cast<Argument>(V)) {
    add(1);
    return add(A->getArgNo());
  }
  if (const auto *Assembly = dyn_cast<InlineAsm>(V))
    return add(StringRef(Assembly->getAsmString()));
  add(2);
  add(Numbers.lookup(V));
}

void Sum::add(const Instruction &I) {
  add(I.getOpcode());
  add(I.getType());
  if (const DILocation *Loc = I.getDebugLoc()) {
    add(Loc->getLine());
    add(Loc->getColumn());
  }
  if (const auto *C = dyn_cast<CmpInst>(&I))
    add(C->getPredicate());
  else if (const auto *A = dyn_cast<AllocaInst>(&I))
    add(A->getAllocatedType());
  else if (const auto *GEP = dyn_cast<GetElementPtrInst>(&I))
    add(GEP->getSourceElementType());
  else if (const auto *Call = dyn_cast<CallBase>(&I))
    add(Call->getFunctionType());
  else if (const auto *Phi = dyn_cast<PHINode>(&I))
    for (const BasicBlock *From : Phi->blocks())
      add(From);
  else if (const auto *Switch = dyn_cast<SwitchInst>(&I))
    for (const auto &Case : Switch->cases())
      add(Case.getCaseValue()->getValue());
  else if (const auto *E = dyn_cast<ExtractValueInst>(&I))
    for (unsigned Index : E->indices())
      add(Index);
  else if (const auto *In = dyn_cast<InsertValueInst>(&I))
    for (unsigned Index : In->indices())
      add(Index);
  for (const Use &U : I.operands())
    if (!isa<MetadataAsValue>(U))
      add(U.get());
}

StringRef sourceNameOf(const Function &F) {
  const DISubprogram *SP = F.getSubprogram();
  if (!SP)
    return F.getName();
  return SP->getLinkageName().empty() ? SP->getName() : SP->getLinkageName();
}

std::string checksumOf(const Function &F) { return Sum(F).text(); }

} // namespace tpc
