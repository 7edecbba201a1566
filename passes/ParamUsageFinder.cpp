//===- ParamUsageFinder.cpp -----------------------------------------------===//
#include "ParamUsageFinder.h"

#include "ClassObjectAccess.h"
#include "IfStatements.h"
#include "ParamCallFinder.h"
#include "Print.h"
#include "SimpleCallGraph.h"

#include "llvm/ADT/DenseSet.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

AnalysisKey ParamUsageFinder::Key;

//===----------------------------------------------------------------------===//
// The way forward
//===----------------------------------------------------------------------===//

/// The calls that a value went into, the last one first.
struct CallPath {
  const CallBase *Call;
  const CallPath *Outer;
  unsigned Depth;
};

/// Follows values forward. Two kinds: a parameter's value, up to the
/// comparisons, and a comparison's outcome, up to the predicates.
class Follower {
public:
  Follower(Module &M, ModuleAnalysisManager &AM)
      : Calls(AM.getResult<SimpleCallGraph>(M)),
        Access(AM.getResult<ClassObjectAccess>(M)),
        Reads(AM.getResult<ParamCallFinder>(M)) {}

  ParameterUsage run();

private:
  struct State {
    Value *V;
    Transform How;
    const CallPath *Path;
    bool Direct; ///< of an outcome: see Decision
    /// Where V is an object that is one value: the field that it stands in.
    std::optional<unsigned> Field = std::nullopt;
    /// Where control flow has merged V with other values: the last value
    /// before that.
    Value *Origin = nullptr;
  };
  using Worklist = SmallVector<State, 16>;

  void followRead(unsigned N);
  void useOfValue(const State &S, Use &U, unsigned Read);
  void compared(const State &S, CmpInst &Compare, unsigned Operand,
                unsigned Read);
  void flag(Value *V, Decision D, unsigned Read, bool IsOperand = false);
  SmallVector<Decision, 2> followOutcome(Value *Outcome, const CallPath *Path);
  bool isSquare(const Instruction &I) const;
  bool carry(const State &S, Use &U);
  void push(State S);
  const CallPath *into(const CallBase *Call, const CallPath *Outer);

  const CallGraphResult &Calls;
  const AccessResult &Access;
  const ParamCallFinder::Result &Reads;

  ParameterUsage Usage;
  Worklist Work;
  DenseSet<std::pair<const Value *, const CallBase *>> Seen;
  SmallVector<std::unique_ptr<CallPath>, 16> Paths;
};

/// Calls inside calls that are told apart; deeper ones come out anywhere.
static constexpr unsigned MaxCallDepth = 8;

const CallPath *Follower::into(const CallBase *Call, const CallPath *Outer) {
  if (Outer && Outer->Depth == MaxCallDepth)
    Outer = nullptr;
  Paths.push_back(std::make_unique<CallPath>(
      CallPath{Call, Outer, Outer ? Outer->Depth + 1 : 1}));
  return Paths.back().get();
}

void Follower::push(State S) {
  if (Seen.insert({S.V, S.Path ? S.Path->Call : nullptr}).second)
    Work.push_back(std::move(S));
}

/// True for the intrinsics that give back their first operand.
static bool isCopy(const Instruction &I, const Use &U) {
  const auto *Call = dyn_cast<IntrinsicInst>(&I);
  if (!Call || U.getOperandNo() != 0)
    return false;
  switch (Call->getIntrinsicID()) {
  case Intrinsic::expect:
  case Intrinsic::expect_with_probability:
  case Intrinsic::annotation:
  case Intrinsic::ssa_copy:
    return true;
  default:
    return false;
  }
}

/// Carries what is at \p U on to where it is the same value still: casts,
/// merges, variables, arguments, results. False where \p U does something
/// else with it.
bool Follower::carry(const State &S, Use &U) {
  auto *I = cast<Instruction>(U.getUser());
  if (isa<CastInst>(I) || isa<FreezeInst>(I) || isCopy(*I, U)) {
    push({I, S.How, S.Path, S.Direct, S.Field, S.Origin});
    return true;
  }
  if (isa<PHINode>(I) || (isa<SelectInst>(I) && U.getOperandNo() != 0)) {
    push({I, S.How, S.Path, false, S.Field, S.Origin ? S.Origin : S.V});
    return true;
  }
  if (auto *Insert = dyn_cast<InsertValueInst>(I)) {
    if (Insert->getNumIndices() != 1)
      return false;
    unsigned Field = Insert->getIndices()[0];
    if (!S.Field && U.getOperandNo() == 1)
      push({I, S.How, S.Path, false, Field});
    else if (S.Field && S.Field != Field && U.getOperandNo() == 0)
      push({I, S.How, S.Path, false, S.Field});
    return true;
  }
  if (auto *Extract = dyn_cast<ExtractValueInst>(I)) {
    if (S.Field && Extract->getNumIndices() == 1 &&
        Extract->getIndices()[0] == *S.Field)
      push({I, S.How, S.Path, false});
    return true;
  }
  if (S.Field && !isa<ReturnInst>(I))
    return false;
  if (auto *Store = dyn_cast<StoreInst>(I)) {
    if (U.getOperandNo() == 0)
      for (LoadInst *Load : Access.usesOf(*Store, Store->getPointerOperand()))
        push({Load, S.How, nullptr, false});
    return true;
  }
  if (auto *Call = dyn_cast<CallBase>(I); Call && !isa<IntrinsicInst>(Call)) {
    SmallVector<Function *, 1> Callees = Calls.callees(*Call);
    if (Callees.empty() || !Call->isArgOperand(&U))
      return false;
    for (Function *Callee : Callees)
      if (Call->getArgOperandNo(&U) < Callee->arg_size())
        push({Callee->getArg(Call->getArgOperandNo(&U)), S.How,
              into(Call, S.Path), false});
    return true;
  }
  if (isa<ReturnInst>(I)) {
    if (S.Path)
      push({const_cast<CallBase *>(S.Path->Call), S.How, S.Path->Outer, false,
            S.Field});
    else
      for (CallBase *Call : Calls.callers(I->getFunction()))
        push({Call, S.How, nullptr, false, S.Field});
    return true;
  }
  return false;
}

/// True for the operations that make one truth value of two.
static bool isLogical(const Instruction &I) {
  return I.getOpcode() == Instruction::And ||
         I.getOpcode() == Instruction::Or || I.getOpcode() == Instruction::Xor;
}

/// True where \p I decides by \p U.
static bool decidesBy(const Instruction &I, const Use &U) {
  return isPredicate(I) && U.get() == conditionOf(I) &&
         !(isa<SelectInst>(I) && U.getOperandNo() != 0);
}

/// The predicates that \p Outcome, a truth value, decides.
SmallVector<Decision, 2> Follower::followOutcome(Value *Outcome,
                                                 const CallPath *Path) {
  Worklist OuterWork = std::move(Work);
  auto OuterSeen = std::move(Seen);
  Work.clear();
  Seen.clear();
  SmallVector<Decision, 2> Found;
  push({Outcome, {}, Path, true});
  while (!Work.empty()) {
    State S = Work.pop_back_val();
    for (Use &U : S.V->uses()) {
      auto *I = dyn_cast<Instruction>(U.getUser());
      if (!I)
        continue;
      if (decidesBy(*I, U))
        Found.push_back({I, S.Direct});
      else if (isLogical(*I) || isa<ICmpInst>(I))
        push({I, {}, S.Path, S.Direct});
      else
        carry(S, U);
    }
  }
  Work = std::move(OuterWork);
  Seen = std::move(OuterSeen);
  return Found;
}

void Follower::flag(Value *V, Decision D, unsigned Read, bool IsOperand) {
  ParameterComparison C;
  // An argument has no place of its own: there the flag stands at the branch.
  C.IsOperand = IsOperand && isa<Instruction>(V);
  C.Read = Read;
  C.Flag = V;
  C.Decisions.push_back(D);
  Usage.Comparisons.push_back(std::move(C));
}

/// True where \p I is what `&&` or `||` makes of its last operand \p U: all
/// other ways to it are decided already.
static bool isShortCircuit(const Instruction &I, const Use &U) {
  const auto *Phi = dyn_cast<PHINode>(&I);
  return Phi && Phi->getType()->isIntegerTy(1) &&
         Phi->getNumIncomingValues() > 1 &&
         all_of(Phi->incoming_values(),
                [&](const Use &In) { return &In == &U || isa<Constant>(In); });
}

/// True where \p Compare only asks whether an operand is not zero, as C++ does
/// where a number stands as a condition.
static bool asksForNonZero(const CmpInst &Compare, unsigned Operand) {
  const auto *Zero = dyn_cast<Constant>(Compare.getOperand(1 - Operand));
  return Zero && Zero->isZeroValue() &&
         (Compare.getPredicate() == CmpInst::ICMP_NE ||
          Compare.getPredicate() == CmpInst::FCMP_UNE);
}

void Follower::compared(const State &S, CmpInst &Compare, unsigned Operand,
                        unsigned Read) {
  if (Compare.getOperand(0) == Compare.getOperand(1) ||
      Compare.getOperand(0)->getType()->isPtrOrPtrVectorTy())
    return;
  if (S.How.Kind == Transform::None && asksForNonZero(Compare, Operand)) {
    for (const Decision &D : followOutcome(&Compare, S.Path))
      flag(&Compare, D, Read, /*IsOperand=*/!D.Direct);
    return;
  }
  ParameterComparison C;
  C.Read = Read;
  C.Compare = &Compare;
  C.Operand = Operand;
  C.How = S.How;
  C.ByArgument = S.Path && Calls.callers(Compare.getFunction()).size() > 1;
  C.Decisions = followOutcome(&Compare, S.Path);
  Usage.Comparisons.push_back(std::move(C));
}

/// True where \p A and \p B are computed alike from one pointer.
static bool isSameAddress(const Value *A, const Value *B) {
  if (A == B)
    return true;
  const auto *First = dyn_cast<GetElementPtrInst>(A);
  const auto *Second = dyn_cast<GetElementPtrInst>(B);
  return First && Second && First->getNumIndices() == Second->getNumIndices() &&
         First->getSourceElementType() == Second->getSourceElementType() &&
         std::equal(First->idx_begin(), First->idx_end(),
                    Second->idx_begin()) &&
         isSameAddress(First->getPointerOperand(), Second->getPointerOperand());
}

/// True where \p I multiplies a value with itself, be it that the variable is
/// read twice.
bool Follower::isSquare(const Instruction &I) const {
  if (I.getOpcode() != Instruction::FMul && I.getOpcode() != Instruction::Mul)
    return false;
  const Value *L = I.getOperand(0), *R = I.getOperand(1);
  const auto *First = dyn_cast<LoadInst>(L), *Second = dyn_cast<LoadInst>(R);
  if (L == R || !First || !Second)
    return L == R;
  if (First->getParent() != Second->getParent())
    return false;
  if (isSameAddress(First->getPointerOperand(), Second->getPointerOperand()))
    return true;
  Locations A = Access.resolve(First->getPointerOperand(), true);
  return A.size() == 1 &&
         A == Access.resolve(Second->getPointerOperand(), true);
}

void Follower::useOfValue(const State &S, Use &U, unsigned Read) {
  auto *I = dyn_cast<Instruction>(U.getUser());
  if (!I)
    return;
  if (auto *Compare = dyn_cast<CmpInst>(I))
    return compared(S, *Compare, U.getOperandNo(), Read);
  if (decidesBy(*I, U)) {
    if (S.How.Kind == Transform::None)
      flag(S.Origin ? S.Origin : S.V, {I, !S.Origin}, Read,
           /*IsOperand=*/S.Origin != nullptr);
    return;
  }
  if (isLogical(*I) && S.V->getType()->isIntegerTy(1)) {
    for (Decision D : followOutcome(I, S.Path))
      flag(S.V, D, Read, /*IsOperand=*/!D.Direct);
    return;
  }
  if (isShortCircuit(*I, U) && S.How.Kind == Transform::None &&
      isa<Instruction>(S.V)) {
    for (Decision D : followOutcome(I, S.Path))
      flag(S.V, {D.Predicate, false}, Read, /*IsOperand=*/true);
    return;
  }
  if (carry(S, U))
    return;
  if (std::optional<Transform> T = apply(S.How, *I, S.V, isSquare(*I)))
    push({I, std::move(*T), S.Path, S.Direct});
  else if (!isa<IntrinsicInst>(I) || !I->getType()->isVoidTy())
    ++Usage.Lost;
}

/// True for the types whose values are compared as numbers.
static bool isNumber(StringRef Type) {
  static constexpr StringRef Numbers[] = {
      "bool",  "char",           "signed char", "unsigned char",
      "short", "unsigned short", "int",         "unsigned int",
      "long",  "unsigned long",  "long long",   "unsigned long long",
      "float", "double",         "long double"};
  return is_contained(Numbers, Type);
}

void Follower::followRead(unsigned N) {
  const ParameterRead &Read = Reads[N];
  if (!isNumber(Read.Type)) {
    ++Usage.Lost;
    return;
  }
  Seen.clear();
  if (!Read.Target)
    push({Read.Call, {}, nullptr, true});
  else
    for (LoadInst *Load : Access.usesOf(*Read.Call, Read.Target))
      push({Load, {}, nullptr, true});
  while (!Work.empty()) {
    State S = Work.pop_back_val();
    for (Use &U : S.V->uses())
      useOfValue(S, U, N);
  }
}

ParameterUsage Follower::run() {
  for (unsigned N = 0; N < Reads.size(); ++N)
    followRead(N);
  return std::move(Usage);
}

ParameterUsage ParamUsageFinder::run(Module &M, ModuleAnalysisManager &AM) {
  return Follower(M, AM).run();
}

PreservedAnalyses ParamUsageFinderPrinter::run(Module &M,
                                               ModuleAnalysisManager &AM) {
  const ParameterUsage &R = AM.getResult<ParamUsageFinder>(M);
  const auto &Reads = AM.getResult<ParamCallFinder>(M);
  OS << "parameter usage of " << M.getName() << ": " << R.Comparisons.size()
     << " comparisons, " << R.Lost << " lost\n";
  for (const ParameterComparison &C : R.Comparisons) {
    OS << "  '" << Reads[C.Read].Name << "' as " << C.How.text() << ' ';
    const auto *Where = C.Compare ? cast<Instruction>(C.Compare)
                                  : C.Decisions.front().Predicate;
    OS << (C.Compare ? "compared" : "flag") << " in "
       << Where->getFunction()->getName() << place(*Where);
    for (const Decision &D : C.Decisions)
      OS << (D.Direct ? " decides" : " later decides") << place(*D.Predicate);
    OS << '\n';
  }
  return PreservedAnalyses::all();
}

} // namespace tpc
