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
  };
  SmallVector<Node, 0> Nodes;

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
      if (!I.getType()->isPointerTy())
        continue;
      Node N{&I, {}};
      if (const auto *Phi = dyn_cast<PHINode>(&I))
        append_range(N.Sources, Phi->incoming_values());
      else if (const auto *Select = dyn_cast<SelectInst>(&I))
        N.Sources = {Select->getTrueValue(), Select->getFalseValue()};
      else if (const auto *Call = dyn_cast<CallBase>(&I))
        returned(*Call, N);
      else if (!isa<LoadInst>(&I))
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
    if (const auto *Load = dyn_cast<LoadInst>(N.V))
      for (const Location &L : R.resolve(Load->getPointerOperand(), true))
        if (auto It = R.StoreIndex.find(slot(L)); It != R.StoreIndex.end())
          for (unsigned S : It->second)
            if (R.mayBe(R.Stores[S].Where, L))
              R.addPointees(cast<StoreInst>(R.Stores[S].I)->getValueOperand(),
                            Found);
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
        for (const auto &[N, Arg] : enumerate(Call->args()))
          if (Arg->getType()->isPointerTy() && !Call->onlyReadsMemory(N))
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
  AccessResult::Builder B{R,
                          AM.getResult<SimpleCallGraph>(M),
                          AM.getResult<RuleAnalysis>(M),
                          M,
                          {}};
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
