//===- ManyParameters.cpp -------------------------------------------------===//
#include "params/ManyParameters.h"

#include "params/MadeObjects.h"
#include "params/ParameterObjects.h"
#include "params/Texts.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/Constants.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

#include <set>

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

/// True if the list that \p U, or a pointer to one of its elements, leads to
/// may be changed there.
static bool mayChange(const Use &U, const RuleMatches &Rules) {
  const User *I = U.getUser();
  if (isa<LoadInst, CmpInst>(I))
    return false;
  const auto *Call = dyn_cast<CallBase>(I);
  if (!Call || isa<MemIntrinsic>(Call))
    return true;
  if (isa<IntrinsicInst>(Call))
    return false;
  const Function *Callee = Call->getCalledFunction();
  if (!Callee)
    return true;
  if (leavesUnchanged(*Call, *Callee, U.get()))
    return false;
  // A method that gives access to the elements.
  const ContainerMethod *Method = Rules.container(*Call);
  return !Method || Method->Writes || U.getOperandNo() != 0 ||
         any_of(Call->uses(),
                [&](const Use &Own) { return mayChange(Own, Rules); });
}

/// The texts in \p Array, which has \p Count of them.
static std::vector<std::string> textsOf(const AllocaInst &Array,
                                        const Value *Count,
                                        const DataLayout &Layout,
                                        Texts &Known) {
  std::vector<std::string> Names;
  const auto *T = dyn_cast<ArrayType>(Array.getAllocatedType());
  const auto *Number = dyn_cast<ConstantInt>(Count);
  if (!T || !Number || Number->getValue() != T->getNumElements())
    return Names;
  const uint64_t Size = Layout.getTypeAllocSize(T->getElementType());
  for (uint64_t N = 0; N < T->getNumElements(); ++N) {
    CallBase *Maker = makerAt(Array, N * Size, Layout);
    Names.push_back(Maker ? Known.textAt(Maker->getArgOperand(1), *Maker)
                          : DynamicName);
  }
  return Names;
}

std::vector<std::string> ManyParameters::textsIn(const Value *List) {
  if (!List || !isa<AllocaInst>(List))
    return {};
  std::vector<std::string> Names;
  for (const Use &U : List->uses()) {
    const auto *Made = dyn_cast<CallBase>(U.getUser());
    const Function *F = Made ? Made->getCalledFunction() : nullptr;
    const auto *Array = F && Made->arg_size() > 2
                            ? dyn_cast<AllocaInst>(Made->getArgOperand(1))
                            : nullptr;
    const bool Makes = Array && U.getOperandNo() == 0 &&
                       qualifiedName(F->getName()) == "std::vector::vector";
    if (Makes && Names.empty())
      Names = textsOf(*Array, Made->getArgOperand(2),
                      F->getParent()->getDataLayout(), Known);
    else if (Makes || mayChange(U, Rules))
      return {};
  }
  return Names;
}

void ManyParameters::addList(CallBase &Call, const Rule &Row) {
  std::vector<std::string> Names = textsIn(argument(Call, Row, Row.Name));
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

/// The numbers that are loaded from the object that \p Element points to. An
/// iterator that is moved on leads to others.
static SmallVector<Value *, 1> numbersAt(CallBase &Element) {
  SmallVector<Value *, 1> Numbers;
  SmallVector<Value *, 4> Pointers{&Element};
  while (!Pointers.empty())
    for (User *U : Pointers.pop_back_val()->users()) {
      if (isa<GetElementPtrInst>(U))
        Pointers.push_back(U);
      else if (isa<LoadInst>(U) && !U->getType()->isPointerTy())
        Numbers.push_back(U);
    }
  return Numbers;
}

/// True if the iterator \p Found may be moved on to another element.
static bool isMoved(const CallBase &Found) {
  return any_of(Found.users(), [](const User *U) {
    return !isa<GetElementPtrInst, LoadInst, CmpInst>(U);
  });
}

ArrayRef<ManyParameters::Access> ManyParameters::accesses() {
  if (Accesses)
    return *Accesses;
  Accesses.emplace();
  for (Function &F : definedFunctions(M)) {
    if (Rules.isOpaque(F))
      continue;
    for (Instruction &I : instructions(F)) {
      auto *Call = dyn_cast<CallBase>(&I);
      if (!Call || !Call->getType()->isPointerTy() || Call->arg_empty() ||
          !Rules.container(*Call))
        continue;
      const std::string Method = methodOf(*Call);
      const bool Finds = Method == "find";
      const bool HasKey = Call->arg_size() == 2 &&
                          Call->getArgOperand(1)->getType()->isPointerTy();
      Access A{Call, Pointers.resolve(Call->getArgOperand(0), false), nullptr};
      if (HasKey && (Finds || Method == "operator[]" || Method == "at"))
        A.Key = Call->getArgOperand(1);
      else if (Method == "end" || Method == "cend")
        continue;
      A.IsMoved = Finds && isMoved(*Call);
      Accesses->push_back(std::move(A));
    }
  }
  return *Accesses;
}

void ManyParameters::addMap(CallBase &Call, const Rule &Row) {
  const Value *Map = argument(Call, Row, Row.Value);
  // A row may say more arguments than this function has.
  if (!Map || !Map->getType()->isPointerTy())
    return;
  const std::string Prefix = Known.nameOf(Call, Row);
  const std::string Type = functionArgument(*Call.getCalledFunction());
  auto Add = [&](StringRef Key, SmallVector<Value *, 1> Values) {
    if (!Values.empty())
      Reads.push_back({&Call, &Row, below(Prefix, Key), Type, nullptr, nullptr,
                       std::move(Values)});
  };
  const Locations Where = Pointers.resolve(Map, false);
  const bool HasObjects = isObjectType(Type, Rules);
  std::set<std::string> Keys;
  SmallVector<Value *, 1> Objects;
  SmallPtrSet<const Value *, 8> Looked;
  for (const Access &A : accesses()) {
    if (none_of(A.Map, [&](const Location &L) {
          return any_of(Where, [&](const Location &W) { return L.mayBe(W); });
        }))
      continue;
    if (HasObjects) {
      Keys.insert(A.Key && !A.IsMoved ? Known.textAt(A.Key, *A.Call)
                                      : DynamicName);
      Objects.push_back(A.Call);
    } else if (A.Key) {
      SmallVector<Value *, 1> Numbers = numbersAt(*A.Call);
      Looked.insert(Numbers.begin(), Numbers.end());
      Add(Known.textAt(A.Key, *A.Call), std::move(Numbers));
    }
  }
  // The analysis does not tell the objects in one map apart.
  if (HasObjects)
    return Add(Keys.size() == 1 ? StringRef(*Keys.begin()) : DynamicName,
               std::move(Objects));
  // What a loop goes through.
  Locations Elements;
  Pointers.addElements(Map, Elements);
  SmallVector<Value *, 1> Others;
  for (LoadInst *Load : Writes.elementsFrom(/*Write=*/nullptr, Elements))
    if (!Looked.contains(Load))
      Others.push_back(Load);
  Add(DynamicName, std::move(Others));
}

ManyParameters::ManyParameters(Module &M, ModuleAnalysisManager &AM,
                               Texts &Known, std::vector<ParameterRead> &Reads)
    : M(M), Rules(AM.getResult<RuleAnalysis>(M)),
      Pointers(AM.getResult<PointsToAnalysis>(M)),
      Writes(AM.getResult<VisibleWritesAnalysis>(M)), Known(Known),
      Reads(Reads) {}

void ManyParameters::add(CallBase &Call, const Rule &Row) {
  if (Row.Many == Rule::List)
    addList(Call, Row);
  else
    addMap(Call, Row);
}

} // namespace tpc
