//===- FunctionPointers.cpp -----------------------------------------------===//
#include "calls/FunctionPointers.h"

#include "calls/ClassHierarchy.h"
#include "support/Functions.h"

#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

/// There is one search for each indirect call. Without a limit, link units with
/// many callbacks would take quadratic time. Beyond the limit the call counts
/// as unresolved.
static cl::opt<unsigned> MaxVisited(
    "tpc-max-pointer-steps", cl::Hidden, cl::init(20000),
    cl::desc("Places visited in search of the targets of one indirect call"));
/// If more targets are found, they are usually all functions of one type, which
/// says nothing; the call counts as unresolved.
static cl::opt<unsigned>
    MaxTargets("tpc-max-call-targets", cl::Hidden, cl::init(64),
               cl::desc("Functions that one indirect call may enter"));

/// The cell of the scalar at the beginning of an object of type \p T at
/// \p Where.
static std::pair<const void *, unsigned>
enter(Type *T, std::pair<const void *, unsigned> Where) {
  while (auto *Struct = dyn_cast<StructType>(T)) {
    if (Struct->isOpaque() || Struct->getNumElements() == 0)
      break;
    // A literal struct is how clang passes a pair of registers; it is not a
    // class.
    if (!Struct->isLiteral())
      Where = {Struct, 0};
    T = Struct->getElementType(0);
  }
  return Where;
}

FunctionPointers::Cell FunctionPointers::findCell(const Value *Pointer) {
  while (true) {
    const auto *GEP = dyn_cast<GEPOperator>(Pointer);
    if (!GEP)
      break;
    Cell Found{nullptr, NoIndex};
    Type *T = GEP->getSourceElementType();
    for (const Use &U : drop_begin(GEP->indices())) {
      if (auto *Struct = dyn_cast<StructType>(T);
          Struct && !Struct->isLiteral())
        Found = {Struct, static_cast<unsigned>(
                             cast<ConstantInt>(U.get())->getZExtValue())};
      T = GetElementPtrInst::getTypeAtIndex(T, U.get());
    }
    if (Found.first)
      return enter(T, Found);
    Pointer = GEP->getPointerOperand();
  }
  if (const auto *Local = dyn_cast<AllocaInst>(Pointer))
    return enter(Local->getAllocatedType(), {Pointer, NoIndex});
  if (const auto *Global = dyn_cast<GlobalVariable>(Pointer))
    return enter(Global->getValueType(), {Pointer, NoIndex});
  // Null is shared by all modules, and later versions of LLVM do not keep a
  // list of its uses.
  if (isa<ConstantData>(Pointer))
    return {Pointer, NoIndex};
  // A pointer without a type of its own gets the type of the fields reached
  // from it. The first getelementptr on the way must not move the pointer.
  for (const User *U : Pointer->users())
    if (const auto *GEP = dyn_cast<GetElementPtrInst>(U);
        GEP && isa<StructType>(GEP->getSourceElementType()))
      return enter(GEP->getSourceElementType(), {Pointer, NoIndex});
  return {Pointer, NoIndex};
}

FunctionPointers::Cell FunctionPointers::cellOf(const Value *Pointer) {
  auto [It, New] = CellOf.try_emplace(Pointer);
  if (New)
    It->second = findCell(Pointer);
  return It->second;
}

void FunctionPointers::addInitializer(const Constant *C, Cell Where) {
  if (const auto *Struct = dyn_cast<ConstantStruct>(C)) {
    StructType *T = Struct->getType();
    for (unsigned N = 0; N < T->getNumElements(); ++N)
      addInitializer(Struct->getOperand(N),
                     T->isLiteral() ? Where : Cell{T, N});
    return;
  }
  if (const auto *Array = dyn_cast<ConstantArray>(C)) {
    for (const Use &U : Array->operands())
      addInitializer(cast<Constant>(U.get()), Where);
    return;
  }
  if (isa<ConstantExpr>(C) || isa<GlobalValue>(C))
    Stored[Where].push_back(C);
}

/// True for types that can hold the address of a function. Pointers to members
/// are pairs of integers.
static bool canCarry(const Type *T) {
  if (const auto *Struct = dyn_cast<StructType>(T))
    return any_of(Struct->elements(), canCarry);
  return T->isPointerTy() || T->isIntegerTy(64);
}

FunctionPointers::FunctionPointers(Module &M) {
  for (const GlobalVariable &G : M.globals())
    if (G.hasInitializer() && !G.getName().starts_with("_ZTV"))
      addInitializer(G.getInitializer(), {&G, NoIndex});
  for (Function &F : definedFunctions(M))
    for (Instruction &I : instructions(F)) {
      if (auto *Store = dyn_cast<StoreInst>(&I)) {
        const Value *V = Store->getValueOperand();
        if (canCarry(V->getType()) && !isa<ConstantData>(V))
          Stored[cellOf(Store->getPointerOperand())].push_back(V);
      } else if (auto *Copy = dyn_cast<MemTransferInst>(&I)) {
        Cell To = cellOf(Copy->getRawDest()),
             From = cellOf(Copy->getRawSource());
        if (To != From)
          CopiedFrom[To].insert(From);
      }
    }
}

/// One backward search from a callee to the functions that it can be.
struct FunctionPointers::Search {
  FunctionPointers &All;
  const CallBase &Call;
  CallersTy Callers;
  SmallSetVector<Function *, 4> Found;
  DenseSet<const Value *> SeenValues;
  DenseSet<Cell> SeenCells;
  SmallVector<const Value *, 16> Values;
  SmallVector<Cell, 16> Cells;
  bool IsTooFar = false;

  void value(const Value *V) {
    if (SeenValues.insert(V).second)
      Values.push_back(V);
  }
  void cell(Cell C) {
    IsTooFar |= All.TooFar.contains(C);
    if (SeenCells.insert(C).second)
      Cells.push_back(C);
  }
  void memory(const Value *Pointer) { cell(All.cellOf(Pointer)); }
  template <typename Fn> void eachActual(const Argument &Arg, Fn F) {
    for (const CallBase *Caller : Callers(Arg.getParent()))
      if (Arg.getArgNo() < Caller->arg_size())
        F(Caller->getArgOperand(Arg.getArgNo()));
  }
  template <typename Fn> void eachReturned(const CallBase &C, Fn F) {
    if (const Function *Callee = C.getCalledFunction())
      for (const BasicBlock &BB : *Callee)
        if (const auto *Return = dyn_cast<ReturnInst>(BB.getTerminator()))
          if (const Value *V = Return->getReturnValue())
            F(V);
  }
  void step(const Value *V);
  void step(Cell C);
  void run(const Value *Callee);
};

void FunctionPointers::Search::step(const Value *V) {
  if (auto *F = const_cast<Function *>(dyn_cast<Function>(V))) {
    if (fits(Call, *F))
      Found.insert(F);
    return;
  }
  if (const auto *Load = dyn_cast<LoadInst>(V))
    return memory(Load->getPointerOperand());
  if (const auto *Arg = dyn_cast<Argument>(V))
    return eachActual(*Arg, [&](const Value *A) { value(A); });
  if (const auto *Inner = dyn_cast<CallBase>(V)) {
    eachReturned(*Inner, [&](const Value *R) { value(R); });
    return;
  }
  if (isa<GlobalVariable>(V) || isa<GEPOperator>(V))
    return;
  if (const auto *U = dyn_cast<User>(V))
    for (const Use &Operand : U->operands())
      if (canCarry(Operand->getType()))
        value(Operand);
}

void FunctionPointers::Search::step(Cell C) {
  if (auto It = All.Stored.find(C); It != All.Stored.end())
    for (const Value *V : It->second)
      value(V);
  if (auto It = All.CopiedFrom.find(C); It != All.CopiedFrom.end())
    for (Cell Source : It->second)
      cell(Source);
}

void FunctionPointers::Search::run(const Value *Callee) {
  value(Callee);
  while (!Values.empty() || !Cells.empty()) {
    IsTooFar |= SeenValues.size() + SeenCells.size() > MaxVisited;
    if (IsTooFar)
      if (const auto *Load = dyn_cast<LoadInst>(Callee))
        All.TooFar.insert(All.cellOf(Load->getPointerOperand()));
    if (IsTooFar || Found.size() > MaxTargets)
      return Found.clear();
    if (!Values.empty()) {
      step(Values.pop_back_val());
      continue;
    }
    Cell C = Cells.pop_back_val();
    step(C);
    if (C.second != NoIndex)
      continue;
    // The object that a pointer leads to has other names where the pointer came
    // from and, for a variable, where it was passed to.
    const Value *Base = static_cast<const Value *>(C.first);
    if (const auto *Arg = dyn_cast<Argument>(Base)) {
      eachActual(*Arg, [&](const Value *A) { memory(A); });
    } else if (const auto *Phi = dyn_cast<PHINode>(Base)) {
      for (const Value *In : Phi->incoming_values())
        memory(In);
    } else if (const auto *Inner = dyn_cast<CallBase>(Base)) {
      eachReturned(*Inner, [&](const Value *R) { memory(R); });
    } else if (const auto *Load = dyn_cast<LoadInst>(Base)) {
      if (auto It = All.Stored.find(All.cellOf(Load->getPointerOperand()));
          It != All.Stored.end())
        for (const Value *Target : It->second)
          memory(Target);
    } else if (isa<AllocaInst>(Base) || isa<GlobalVariable>(Base)) {
      for (const Use &U : Base->uses())
        if (const auto *Handed = dyn_cast<CallBase>(U.getUser());
            Handed && Handed->isArgOperand(&U))
          if (const Function *Inside = Handed->getCalledFunction();
              Inside && Handed->getArgOperandNo(&U) < Inside->arg_size())
            memory(Inside->getArg(Handed->getArgOperandNo(&U)));
    }
  }
}

SmallVector<Function *, 2> FunctionPointers::targets(const CallBase &Call,
                                                     CallersTy Callers) {
  Search S{*this, Call, Callers, {}, {}, {}, {}, {}};
  S.run(Call.getCalledOperand());
  SmallVector<Function *, 2> Out(S.Found.begin(), S.Found.end());
  return Out;
}

} // namespace tpc
