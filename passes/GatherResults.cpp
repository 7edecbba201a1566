//===- GatherResults.cpp --------------------------------------------------===//
#include "GatherResults.h"

#include "Budget.h"
#include "IfStatements.h"
#include "Names.h"
#include "Options.h"
#include "ParamCallFinder.h"
#include "Print.h"

#include "llvm/ADT/EquivalenceClasses.h"
#include "llvm/ADT/SetVector.h"
#include "llvm/ADT/StringExtras.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/SHA1.h"

using namespace llvm;

namespace tpc {

AnalysisKey GatherResults::Key;

StringRef Comparison::typeName() const {
  switch (Type) {
  case Parameter:
    return "parameter";
  case Flag:
    return "flag";
  case Derived:
    return "derived";
  }
  llvm_unreachable("no such type");
}

StringRef Comparison::relation() const {
  if (!Compare)
    return "flag";
  CmpInst::Predicate P =
      Threshold == 1 ? Compare->getPredicate() : Compare->getSwappedPredicate();
  switch (P) {
  case CmpInst::ICMP_EQ:
  case CmpInst::FCMP_OEQ:
  case CmpInst::FCMP_UEQ:
    return "==";
  case CmpInst::ICMP_NE:
  case CmpInst::FCMP_ONE:
  case CmpInst::FCMP_UNE:
    return "!=";
  case CmpInst::ICMP_SGT:
  case CmpInst::ICMP_UGT:
  case CmpInst::FCMP_OGT:
  case CmpInst::FCMP_UGT:
    return ">";
  case CmpInst::ICMP_SGE:
  case CmpInst::ICMP_UGE:
  case CmpInst::FCMP_OGE:
  case CmpInst::FCMP_UGE:
    return ">=";
  case CmpInst::ICMP_SLT:
  case CmpInst::ICMP_ULT:
  case CmpInst::FCMP_OLT:
  case CmpInst::FCMP_ULT:
    return "<";
  default:
    return "<=";
  }
}

/// The nearest of the predicates that \p C decides and that an exposing
/// statement depends on; of several equally near ones the first.
static bool nearest(const ParameterComparison &C, const SliceResult &Slice,
                    Comparison &Out) {
  bool Found = false;
  for (const Decision &D : C.Decisions) {
    std::optional<SliceEntry> E = Slice.lookup(D.Predicate);
    if (!E || (Found && E->Distance >= Out.Slice.Distance))
      continue;
    Found = true;
    Out.Predicate = D.Predicate;
    Out.Direct = D.Direct;
    Out.Slice = *E;
  }
  return Found;
}

/// The next conditional branch on the way from \p BB that runs nothing
/// conditional in between.
static const BranchInst *nextBranch(const BasicBlock *BB) {
  for (unsigned Steps = 0; Steps < 16; ++Steps) {
    const Instruction *T = BB->getTerminator();
    if (const auto *Invoke = dyn_cast<InvokeInst>(T)) {
      BB = Invoke->getNormalDest();
      continue;
    }
    const auto *Br = dyn_cast<BranchInst>(T);
    if (!Br || Br->isConditional())
      return Br;
    BB = Br->getSuccessor(0);
  }
  return nullptr;
}

/// True where \p B begins a statement in the block in which \p A is part of
/// another one, as `bool In = A && ...; if (In)`. Clang 19 gives both the scope
/// of the block; later ones give a statement's condition the scope of its own.
static bool nextStatement(const DILocation &A, const DILocation &B) {
  const auto *Own = dyn_cast<DILexicalBlock>(B.getScope());
  const auto *Around = dyn_cast<DILexicalBlock>(A.getScope());
  return Own && Own->getScope() == A.getScope() &&
         Own->getLine() == B.getLine() && Own->getColumn() == B.getColumn() &&
         !(Around && Around->getLine() == A.getLine());
}

/// True where \p A and \p B can belong to one condition, A before B. Clang
/// gives a statement's condition a scope of its own, in which all operands
/// stand but (in clang 19) the last; that one has the statement's place.
static bool sameStatement(const BranchInst &A, const BranchInst &B) {
  const DILocation *LocA = A.getDebugLoc(), *LocB = B.getDebugLoc();
  if (!LocA || !LocB)
    return false;
  if (nextStatement(*LocA, *LocB))
    return true;
  const auto *Scope = dyn_cast<DILexicalBlock>(LocA->getScope());
  return LocA->getScope() == LocB->getScope() ||
         (Scope && Scope->getScope() == LocB->getScope() &&
          Scope->getLine() == LocB->getLine() &&
          Scope->getColumn() == LocB->getColumn());
}

/// The ways out of \p Br, past blocks that only end a condition.
static SmallVector<const BasicBlock *, 2> waysOut(const BranchInst &Br) {
  SmallVector<const BasicBlock *, 2> Ways;
  for (const BasicBlock *S : successors(&Br)) {
    const BasicBlock *On = decidedWay(Br.getParent(), S);
    Ways.push_back(On ? On : S);
  }
  return Ways;
}

/// The branches that are operands of one `&&` or `||` with \p First and come
/// after it: of its statement, and with a way out that is also its own.
static SmallVector<const BranchInst *, 4>
sameCondition(const BranchInst &First) {
  SmallVector<const BranchInst *, 4> Found;
  SmallSetVector<const BranchInst *, 8> Chain;
  Chain.insert(&First);
  for (unsigned N = 0; N < Chain.size() && N < 16; ++N)
    for (const BasicBlock *S : successors(Chain[N])) {
      const BranchInst *Next = nextBranch(S);
      if (Next && sameStatement(First, *Next))
        Chain.insert(Next);
    }
  SmallVector<const BasicBlock *, 2> Own = waysOut(First);
  for (const BranchInst *Br : drop_begin(Chain))
    if (any_of(waysOut(*Br),
               [&](const BasicBlock *W) { return is_contained(Own, W); }))
      Found.push_back(Br);
  return Found;
}

/// Counts for each comparison the others of its condition.
static void countOthers(std::vector<Comparison> &All) {
  EquivalenceClasses<const Instruction *> Conditions;
  SmallSetVector<const BranchInst *, 8> Work;
  for (const Comparison &C : All) {
    Conditions.insert(C.Predicate);
    if (const auto *Br = dyn_cast<BranchInst>(C.Predicate))
      Work.insert(Br);
  }
  for (unsigned N = 0; N < Work.size(); ++N)
    for (const BranchInst *Br : sameCondition(*Work[N])) {
      Conditions.unionSets(Work[N], Br);
      Work.insert(Br);
    }
  // Of each condition, and of each comparison in it.
  DenseMap<const Instruction *, unsigned> InCondition;
  DenseMap<std::pair<const Instruction *, const CmpInst *>, unsigned> Alike;
  for (const Comparison &C : All) {
    const Instruction *Condition = Conditions.getLeaderValue(C.Predicate);
    ++InCondition[Condition];
    ++Alike[{Condition, C.Compare}];
  }
  for (Comparison &C : All) {
    const Instruction *Condition = Conditions.getLeaderValue(C.Predicate);
    C.OtherThresholds = InCondition[Condition] -
                        (C.Compare ? Alike[{Condition, C.Compare}] : 1);
  }
}

/// A UUID of version 5 (RFC 4122) of \p Name, in a namespace of our own.
static std::string uuidOf(StringRef Name) {
  static constexpr uint8_t Namespace[16] = {0x6b, 0x0f, 0x7a, 0x52, 0x2c, 0x9e,
                                            0x4d, 0x61, 0x9a, 0x37, 0x8f, 0x15,
                                            0xc3, 0x40, 0x5e, 0xd8};
  SHA1 Hash;
  Hash.update(ArrayRef(Namespace));
  Hash.update(Name);
  std::array<uint8_t, 20> Digest = Hash.final();
  Digest[6] = (Digest[6] & 0x0f) | 0x50;
  Digest[8] = (Digest[8] & 0x3f) | 0x80;
  std::string Hex = toHex(ArrayRef(Digest).take_front(16), /*LowerCase=*/true);
  return Hex.substr(0, 8) + "-" + Hex.substr(8, 4) + "-" + Hex.substr(12, 4) +
         "-" + Hex.substr(16, 4) + "-" + Hex.substr(20);
}

/// Gives the comparisons their keys. What a macro writes several times has one
/// place; there the order in the function tells it apart. Instances of one
/// function have the same keys.
static void nameAll(std::vector<Comparison> &All, const Options &Opts,
                    const ParamCallFinder::Result &Reads) {
  StringMap<MapVector<const Function *, SmallVector<const Instruction *, 1>>>
      Places;
  for (Comparison &C : All) {
    const DILocation *Loc = C.place().getDebugLoc();
    std::string Name = join(
        std::initializer_list<std::string>{
            Opts.Package, Opts.LinkUnit, Opts.relative(pathOf(Loc)),
            functionName(*C.place().getFunction()),
            std::to_string(Loc->getLine()), std::to_string(Loc->getColumn()),
            Reads[C.Reads.front()].Name},
        "\n");
    auto &Here = Places[Name][C.place().getFunction()];
    auto *Known = find(Here, &C.place());
    if (size_t Ordinal = Known - Here.begin())
      Name += "\n" + std::to_string(Ordinal);
    if (Known == Here.end())
      Here.push_back(&C.place());
    C.Key = uuidOf(Name);
  }
}

GatheredResults GatherResults::run(Module &M, ModuleAnalysisManager &AM) {
  const ParameterUsage &Usage = AM.getResult<ParamUsageFinder>(M);
  const ParamCallFinder::Result &Reads = AM.getResult<ParamCallFinder>(M);
  const SliceResult &Slice = AM.getResult<BackwardPropagate>(M);
  const Options Opts = Options::fromCommandLine();
  UserSources Sources(Opts);
  GatheredResults R;
  for (const ParameterComparison &P : Usage.Comparisons) {
    if (Budget::isSpent())
      break;
    Comparison C{};
    if (!nearest(P, Slice, C))
      continue;
    C.Compare = P.Compare;
    C.Threshold = P.Operand;
    C.FlagValue = P.Flag;
    C.IsOperand = P.IsOperand;
    C.How = P.How;
    C.Type = P.Flag                          ? Comparison::Flag
             : P.How.Kind == Transform::None ? Comparison::Parameter
                                             : Comparison::Derived;
    C.Reads.push_back(P.Read);
    const DILocation *Loc = C.place().getDebugLoc();
    if (!Loc) {
      ++R.WithoutDebugInfo;
      continue;
    }
    if (!Sources.has(Loc)) {
      ++R.OutsideSources;
      continue;
    }
    if (P.ByArgument && P.Compare)
      R.Shared.insert(P.Compare->getFunction());
    // A second read of the same parameter is the same comparison.
    auto Same = find_if(R.Comparisons, [&](const Comparison &O) {
      return O.Compare == C.Compare && O.Predicate == C.Predicate &&
             O.FlagValue == C.FlagValue && O.Threshold == C.Threshold &&
             Reads[O.Reads.front()].Name == Reads[P.Read].Name;
    });
    if (Same == R.Comparisons.end())
      R.Comparisons.push_back(std::move(C));
    else if (!is_contained(Same->Reads, P.Read))
      Same->Reads.push_back(P.Read);
  }
  countOthers(R.Comparisons);
  nameAll(R.Comparisons, Opts, Reads);
  return R;
}

PreservedAnalyses GatherResultsPrinter::run(Module &M,
                                            ModuleAnalysisManager &AM) {
  const GatheredResults &R = AM.getResult<GatherResults>(M);
  const auto &Reads = AM.getResult<ParamCallFinder>(M);
  OS << "threshold predicate comparisons of " << M.getName() << ": "
     << R.Comparisons.size() << '\n';
  for (const Comparison &C : R.Comparisons)
    OS << "  " << C.typeName() << " '" << Reads[C.Reads.front()].Name
       << "' relation " << C.relation() << " as " << C.How.text()
       << " distance " << C.Slice.Distance << " others " << C.OtherThresholds
       << " in " << C.place().getFunction()->getName() << tpc::place(C.place())
       << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
