//===- ManyParameters.cpp -------------------------------------------------===//
#include "params/ManyParameters.h"

#include "memory/VisibleWrites.h"
#include "params/ParameterObjects.h"
#include "params/Texts.h"
#include "support/Names.h"

#include "llvm/IR/Constants.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

/// The name of the method that \p Call calls, without scopes.
static std::string methodOf(const CallBase &Call) {
  const Function *F = Call.getCalledFunction();
  return F ? unscoped(qualifiedName(F->getName())).str() : "";
}

std::optional<unsigned> indexOf(const Value *Element) {
  const auto *Call = dyn_cast<CallBase>(Element);
  if (!Call)
    return std::nullopt;
  const std::string Method = methodOf(*Call);
  if (Method == "front" && Call->arg_size() == 1)
    return 0;
  const auto *Index = Call->arg_size() == 2
                          ? dyn_cast<ConstantInt>(Call->getArgOperand(1))
                          : nullptr;
  if (!Index || (Method != "operator[]" && Method != "at"))
    return std::nullopt;
  return static_cast<unsigned>(Index->getLimitedValue(~0U));
}

/// The call in the function of \p Array that makes its element at \p Offset, in
/// bytes; null if there is no single one.
static CallBase *makerAt(const Value &Array, int64_t Offset,
                         const DataLayout &Layout) {
  CallBase *Found = nullptr;
  SmallVector<std::pair<const Value *, int64_t>, 8> Work{{&Array, 0}};
  while (!Work.empty()) {
    auto [Pointer, At] = Work.pop_back_val();
    for (const Use &U : Pointer->uses()) {
      auto *GEP = dyn_cast<GetElementPtrInst>(U.getUser());
      APInt Step(Layout.getIndexTypeSizeInBits(Pointer->getType()), 0);
      if (GEP && GEP->accumulateConstantOffset(Layout, Step))
        Work.push_back({GEP, At + Step.getSExtValue()});
      auto *Call = dyn_cast<CallBase>(U.getUser());
      if (!Call || At != Offset || Call->arg_size() < 2 ||
          U.getOperandNo() != 0 || methodOf(*Call) != "basic_string")
        continue;
      if (Found)
        return nullptr;
      Found = Call;
    }
  }
  return Found;
}

/// The texts that \p List, a std::vector, was made of where it was written in
/// braces; none if it was not.
static std::vector<std::string> textsIn(const Value *List, Texts &Known) {
  std::vector<std::string> Names;
  if (!List || !isa<AllocaInst>(List))
    return Names;
  for (const User *U : List->users()) {
    const auto *Made = dyn_cast<CallBase>(U);
    const Function *F = Made ? Made->getCalledFunction() : nullptr;
    if (!F || Made->arg_size() < 3 || Made->getArgOperand(0) != List ||
        qualifiedName(F->getName()) != "std::vector::vector")
      continue;
    const auto *Array = dyn_cast<AllocaInst>(Made->getArgOperand(1));
    const auto *Count = dyn_cast<ConstantInt>(Made->getArgOperand(2));
    const DataLayout &Layout = F->getParent()->getDataLayout();
    auto *T = Array ? dyn_cast<ArrayType>(Array->getAllocatedType()) : nullptr;
    if (!T || !Count || Count->getValue() != T->getNumElements() ||
        !Names.empty())
      return {};
    for (uint64_t N = 0; N < T->getNumElements(); ++N) {
      CallBase *Maker = makerAt(
          *Array, N * Layout.getTypeAllocSize(T->getElementType()), Layout);
      Names.push_back(Maker ? Known.textAt(Maker->getArgOperand(1), *Maker)
                            : DynamicName);
    }
  }
  return Names;
}

static void addList(CallBase &Call, const Rule &Row, Texts &Known,
                    std::vector<ParameterRead> &Reads) {
  std::vector<std::string> Names =
      textsIn(argument(Call, Row, Row.Name), Known);
  if (Names.empty())
    Names.push_back(DynamicName);
  const bool IsOne = Names.size() == 1;
  for (const auto &[N, Name] : enumerate(Names)) {
    ParameterRead Read{&Call, &Row, Name, "", nullptr, nullptr};
    if (!IsOne)
      Read.Index = N;
    Reads.push_back(std::move(Read));
  }
}

/// A name below \p Prefix.
static std::string below(StringRef Prefix, StringRef Key) {
  return Prefix.empty() ? Key.str() : (Prefix + "." + Key).str();
}

static void addMap(CallBase &Call, const Rule &Row, ModuleAnalysisManager &AM,
                   Texts &Known, std::vector<ParameterRead> &Reads) {
  Module &M = *Call.getModule();
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  PointsTo &Pointers = AM.getResult<PointsToAnalysis>(M);
  const Value *Map = argument(Call, Row, Row.Value);
  const std::string Prefix = Known.nameOf(Call, Row);
  const std::string Type = functionArgument(*Call.getCalledFunction());
  Locations Elements;
  Pointers.addElements(Map, Elements);
  auto Add = [&](StringRef Key, SmallVector<Value *, 1> Values) {
    if (!Values.empty())
      Reads.push_back({&Call, &Row, below(Prefix, Key), Type, nullptr, nullptr,
                       std::move(Values)});
  };
  SmallPtrSet<const Value *, 8> Looked;
  for (Function &F : definedFunctions(M))
    for (Instruction &I : instructions(F)) {
      auto *Look = dyn_cast<CallBase>(&I);
      if (!Look || Look->arg_size() != 2 || !Rules.container(*Look) ||
          !Look->getType()->isPointerTy())
        continue;
      const std::string Method = methodOf(*Look);
      Locations Own;
      if (Method == "operator[]" || Method == "at")
        Pointers.addElements(Look->getArgOperand(0), Own);
      if (none_of(Own, [&](const Location &L) {
            return any_of(Elements,
                          [&](const Location &E) { return L.mayBe(E); });
          }))
        continue;
      SmallVector<Value *, 1> Values = valuesOf(*Look);
      Looked.insert(Values.begin(), Values.end());
      if (isObjectType(Type, Rules))
        Values = {Look};
      Add(Known.textAt(Look->getArgOperand(1), *Look), std::move(Values));
    }
  // What a loop goes through.
  SmallVector<Value *, 1> Others;
  for (LoadInst *Load : AM.getResult<VisibleWritesAnalysis>(M).elementsFrom(
           /*Write=*/nullptr, Elements))
    if (!Looked.contains(Load))
      Others.push_back(Load);
  Add(DynamicName, std::move(Others));
}

void addMany(CallBase &Call, const Rule &Row, ModuleAnalysisManager &AM,
             Texts &Known, std::vector<ParameterRead> &Reads) {
  if (Row.Many == Rule::List)
    addList(Call, Row, Known, Reads);
  else
    addMap(Call, Row, AM, Known, Reads);
}

} // namespace tpc
