//===- AccessBuilder.cpp - Finds where pointers lead, and the accesses ----===//
#include "ClassObjectAccess.h"

#include "Functions.h"
#include "Print.h"
#include "Rules.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

AnalysisKey ClassObjectAccess::Key;

/// Fills an AccessResult.
struct AccessResult::Builder {
  AccessResult &R;
  const CallGraphResult &Calls;
  const RuleMatches &Rules;
  Module &M;

  /// The pointers that a node of the graph takes its targets from.
  struct Node {
    const Value *V;
    SmallVector<const Value *, 2> Sources;
    const Value *Container = nullptr; ///< leads to its elements
  };
  SmallVector<Node, 0> Nodes;
  /// Objects that hold pointers to a container's elements: iterators that are
  /// returned in memory, with the container.
  DenseMap<const Value *, SmallVector<const Value *, 1>> Iterators;

  void addElements(const Value *Container, Locations &Out) const;
  void putInto(const CallBase &Call);
  void findEscaped();
  void makeNodes();
  void returned(const CallBase &Call, Node &N) const;
  bool propagate();
  void fileStores();
  void fileRest();
};

/// Rounds until the pointers lead nowhere new; more than a chain of pointers
/// through memory that is as long is not followed.
static constexpr unsigned MaxRounds = 8;

/// A pointer that a function returned. Where it returns one of its arguments,
/// that of this very call is meant: std::max(a, b) is a or b.
void AccessResult::Builder::returned(const CallBase &Call, Node &N) const {
  for (const Function *Callee : Calls.callees(Call))
    for (const BasicBlock &BB : *Callee) {
      const auto *Return = dyn_cast<ReturnInst>(BB.getTerminator());
      if (!Return || !Return->getReturnValue())
        continue;
      SmallVector<const Value *, 4> Work{Return->getReturnValue()};
      SmallPtrSet<const Value *, 8> Seen;
      while (!Work.empty()) {
        const Value *V = Work.pop_back_val();
        if (!Seen.insert(V).second)
          continue;
        if (const auto *Phi = dyn_cast<PHINode>(V))
          append_range(Work, Phi->incoming_values());
        else if (const auto *Arg = dyn_cast<Argument>(V))
          N.Sources.push_back(Call.getArgOperand(Arg->getArgNo()));
        else
          N.Sources.push_back(V);
      }
    }
}

/// The container that \p Call is a method of.
static const Value *containerOf(const CallBase &Call) {
  unsigned N = Call.hasStructRetAttr() ? 1 : 0;
  return N < Call.arg_size() ? Call.getArgOperand(N) : nullptr;
}

void AccessResult::Builder::addElements(const Value *Container,
                                        Locations &Out) const {
  for (Location L : R.resolve(Container, false)) {
    L.Path.push_back({Step::Element, 0});
    R.addTo(Out, std::move(L));
  }
}

/// What \p Call, a container's method, is handed goes into the elements: the
/// objects themselves, and the elements of other containers.
void AccessResult::Builder::putInto(const CallBase &Call) {
  const Value *Container = containerOf(Call);
  Locations To;
  addElements(Container, To);
  for (const Use &Arg : Call.args()) {
    if (Arg.get() == Container || !Arg->getType()->isPointerTy() ||
        (Call.hasStructRetAttr() && Arg.getOperandNo() == 0))
      continue;
    Locations From = R.resolve(Arg, false);
    addElements(Arg, From);
    for (const Location &L : To)
      R.fileCopy(R.CopiesTo, R.Copies.size(), L);
    for (const Location &L : From)
      R.fileCopy(R.CopiesFrom, R.Copies.size(), L);
    R.Copies.push_back({const_cast<CallBase *>(&Call), To, std::move(From)});
  }
}

/// A local escapes where its address is stored or returned, or goes into a
/// function that is looked into.
void AccessResult::Builder::findEscaped() {
  for (Function &F : definedFunctions(M))
    for (Instruction &I : instructions(F)) {
      if (!isa<AllocaInst>(&I))
        continue;
      SmallVector<const Value *, 8> Work{&I};
      SmallPtrSet<const Value *, 8> Seen;
      while (!Work.empty()) {
        const Value *V = Work.pop_back_val();
        if (!Seen.insert(V).second)
          continue;
        for (const Use &U : V->uses()) {
          const auto *User = cast<Instruction>(U.getUser());
          const auto *Call = dyn_cast<CallBase>(User);
          if (isa<GEPOperator>(User) || isa<CastInst>(User))
            Work.push_back(User);
          else if (isa<PHINode>(User) || isa<SelectInst>(User) ||
                   isa<ReturnInst>(User) ||
                   (isa<StoreInst>(User) && U.getOperandNo() == 0) ||
                   (Call && !Calls.callees(*Call).empty()))
            R.Escaped.insert(&I);
        }
      }
    }
}

void AccessResult::Builder::makeNodes() {
  for (Function &F : definedFunctions(M)) {
    for (const Argument &Arg : F.args()) {
      if (!Arg.getType()->isPointerTy())
        continue;
      Node N{&Arg, {}};
      for (const CallBase *Call : Calls.callers(&F))
        if (Arg.getArgNo() < Call->arg_size())
          N.Sources.push_back(Call->getArgOperand(Arg.getArgNo()));
      Nodes.push_back(std::move(N));
    }
    for (Instruction &I : instructions(F)) {
      if (auto *Call = dyn_cast<CallBase>(&I);
          Call && Call->hasStructRetAttr() && Rules.container(*Call))
        Iterators[Call->getArgOperand(0)].push_back(containerOf(*Call));
      if (!I.getType()->isPointerTy())
        continue;
      Node N{&I, {}};
      if (const auto *Phi = dyn_cast<PHINode>(&I))
        append_range(N.Sources, Phi->incoming_values());
      else if (const auto *Select = dyn_cast<SelectInst>(&I))
        N.Sources = {Select->getTrueValue(), Select->getFalseValue()};
      else if (const auto *Call = dyn_cast<CallBase>(&I);
               Call && Rules.container(*Call))
        N.Container = containerOf(*Call);
      else if (Call)
        returned(*Call, N);
      else if (const auto *Extract = dyn_cast<ExtractValueInst>(&I)) {
        // An iterator and whether something was inserted.
        const auto *Pair = dyn_cast<CallBase>(Extract->getAggregateOperand());
        if (!Pair || !Rules.container(*Pair))
          continue;
        N.Container = containerOf(*Pair);
      } else if (!isa<LoadInst>(&I))
        continue;
      Nodes.push_back(std::move(N));
    }
  }
}

/// One round; true where something new was found.
bool AccessResult::Builder::propagate() {
  bool Changed = false;
  for (const Node &N : Nodes) {
    Locations Found = R.Targets.lookup(N.V);
    size_t Before = Found.size();
    for (const Value *Source : N.Sources)
      R.addPointees(Source, Found);
    if (N.Container)
      addElements(N.Container, Found);
    if (const auto *Load = dyn_cast<LoadInst>(N.V))
      for (const Location &L : R.resolve(Load->getPointerOperand(), true)) {
        // Elements lead to each other where they are kept in nodes.
        if (L.isElement())
          R.addTo(Found, L);
        if (auto It = Iterators.find(L.Root); L.Root && It != Iterators.end())
          for (const Value *Container : It->second)
            addElements(Container, Found);
        if (auto It = R.StoreIndex.find(slot(L)); It != R.StoreIndex.end())
          for (unsigned S : It->second)
            if (R.mayBe(R.Stores[S].Where, L))
              R.addPointees(cast<StoreInst>(R.Stores[S].I)->getValueOperand(),
                            Found);
      }
    if (Found.size() == Before)
      continue;
    Changed = true;
    R.Targets[N.V] = std::move(Found);
  }
  return Changed;
}

void AccessResult::Builder::fileStores() {
  R.Stores.clear();
  R.StoreIndex.clear();
  for (Function &F : definedFunctions(M)) {
    if (Rules.isOpaque(F))
      continue;
    for (Instruction &I : instructions(F))
      if (auto *Store = dyn_cast<StoreInst>(&I))
        for (const Location &L : R.touched(*Store))
          R.file(R.Stores, R.StoreIndex, I, L);
  }
}

/// The object that \p Call is a method of, where that leaves the object alone:
/// it is const, or a container's that puts nothing in.
static const Value *constantObject(const CallBase &Call,
                                   const ContainerMethod *Method) {
  const Function *Callee = Call.getCalledFunction();
  bool IsConst = Method ? !Method->Writes
                        : Callee && Callee->getName().starts_with("_ZNK");
  return IsConst ? containerOf(Call) : nullptr;
}

void AccessResult::Builder::fileRest() {
  for (Function &F : definedFunctions(M)) {
    if (Rules.isOpaque(F))
      continue;
    for (Instruction &I : instructions(F)) {
      if (auto *Load = dyn_cast<LoadInst>(&I)) {
        for (const Location &L : R.touched(*Load))
          R.file(R.Loads, R.LoadIndex, I, L);
      } else if (auto *Copy = dyn_cast<MemTransferInst>(&I)) {
        Locations To = R.resolve(Copy->getRawDest(), false);
        Locations From = R.resolve(Copy->getRawSource(), false);
        for (const Location &L : To)
          R.fileCopy(R.CopiesTo, R.Copies.size(), L);
        for (const Location &L : From)
          R.fileCopy(R.CopiesFrom, R.Copies.size(), L);
        R.Copies.push_back({&I, std::move(To), std::move(From)});
      } else if (auto *Call = dyn_cast<CallBase>(&I);
                 Call && !isa<IntrinsicInst>(Call)) {
        // What is only asked about its text is not written.
        if (const Rule *Row = Rules.match(*Call);
            Row && Row->Kind == Rule::Text && Row->Relation != "copy")
          continue;
        bool Opaque = Calls.callees(*Call).empty();
        const ContainerMethod *Method = Rules.container(*Call);
        if (Method && Method->Writes)
          putInto(*Call);
        const Value *Constant = constantObject(*Call, Method);
        for (const auto &[N, Arg] : enumerate(Call->args()))
          if (Arg->getType()->isPointerTy() && !Call->onlyReadsMemory(N) &&
              Arg.get() != Constant)
            for (const Location &L : R.resolve(Arg, false)) {
              if (Opaque)
                R.file(R.Handed, R.HandedIndex, I, L);
              else
                R.Passed.push_back({&I, L});
            }
      }
    }
  }
}

AccessResult ClassObjectAccess::run(Module &M, ModuleAnalysisManager &AM) {
  AccessResult R;
  R.Layout = &M.getDataLayout();
  R.Debug = std::make_unique<DebugTypes>(*R.Layout);
  AccessResult::Builder B{
      R,
      AM.getResult<SimpleCallGraph>(M),
      AM.getResult<RuleAnalysis>(M),
      M,
      {},
      DenseMap<const Value *, SmallVector<const Value *, 1>>()};
  B.findEscaped();
  B.makeNodes();
  bool Changed = true;
  for (unsigned Round = 0; Round < MaxRounds && Changed; ++Round) {
    Changed = B.propagate();
    B.fileStores();
  }
  B.fileRest();
  return R;
}

PreservedAnalyses ClassObjectAccessPrinter::run(Module &M,
                                                ModuleAnalysisManager &AM) {
  const AccessResult &R = AM.getResult<ClassObjectAccess>(M);
  OS << "accesses of " << M.getName() << '\n';
  auto Print = [&](const char *What, ArrayRef<Access> List) {
    for (const Access &A : List) {
      OS << "  " << What << ' ';
      if (A.Where.Root)
        A.Where.Root->printAsOperand(OS, false);
      for (const Step &S : A.Where.Path) {
        if (!S.isField()) {
          OS << (S.Type == Step::Element ? "[element" : "[byte ");
          if (S.Type == Step::Bytes)
            OS << S.Index;
          OS << ']';
          continue;
        }
        const StructType *T = R.types().typeOf(S.Type);
        OS << '[' << (T->hasName() ? T->getName() : "literal") << '.' << S.Index
           << ']';
      }
      OS << " in " << A.I->getFunction()->getName() << place(*A.I) << '\n';
    }
  };
  Print("load", R.loads());
  Print("store", R.stores());
  return PreservedAnalyses::all();
}

} // namespace tpc
