//===- Prepare.cpp --------------------------------------------------------===//
#include "Prepare.h"

#include "Functions.h"
#include "Options.h"
#include "Rules.h"

#include "llvm/IR/InstIterator.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"
#include "llvm/Passes/PassBuilder.h"
#include "llvm/Transforms/IPO/AlwaysInliner.h"
#include "llvm/Transforms/Scalar/SROA.h"
#include "llvm/Transforms/Utils/BasicBlockUtils.h"
#include "llvm/Transforms/Utils/Cloning.h"

using namespace llvm;

namespace tpc {

/// Functions of libraries with at most this many instructions are inlined.
static constexpr unsigned MaxInlined = 100;

/// The instructions of \p F without the marks that only some levels have.
static unsigned sizeOf(const Function &F) {
  return count_if(instructions(F), [](const Instruction &I) {
    return !isa<AssumeInst>(I) && !I.isDebugOrPseudoInst() &&
           !I.isLifetimeStartOrEnd();
  });
}

/// Marks the small functions of libraries in \p M to be inlined; returns those
/// that were not marked before. What the rules speak of stays a call.
static SmallVector<WeakVH, 0> markSmallLibraryFunctions(Module &M,
                                                        const Options &Opts) {
  SmallVector<WeakVH, 0> Marked;
  Expected<Rules> Tables = Rules::load(Opts);
  if (!Tables) {
    // The analysis will meet the same error, and report it.
    consumeError(Tables.takeError());
    return Marked;
  }
  UserSources Sources(Opts);
  for (Function &F : definedFunctions(M)) {
    if (!F.getSubprogram() || Sources.has(F) ||
        F.hasFnAttribute(Attribute::AlwaysInline) ||
        F.hasFnAttribute(Attribute::NoInline) || sizeOf(F) > MaxInlined ||
        Tables->match(F) || Tables->isOpaque(F) || Tables->isKept(F) ||
        Tables->container(F))
      continue;
    F.addFnAttr(Attribute::AlwaysInline);
    Marked.emplace_back(&F);
  }
  return Marked;
}

/// Makes \p M fit for the analysis.
static void prepare(Module &M, const Options &Opts) {
  // Only there may a value be computed from itself, and following it back would
  // not end.
  for (Function &F : definedFunctions(M))
    EliminateUnreachableBlocks(F);
  SmallVector<WeakVH, 0> Marked = markSmallLibraryFunctions(M, Opts);
  PassBuilder PB;
  LoopAnalysisManager LAM;
  FunctionAnalysisManager FAM;
  CGSCCAnalysisManager CGAM;
  ModuleAnalysisManager MAM;
  PB.registerModuleAnalyses(MAM);
  PB.registerCGSCCAnalyses(CGAM);
  PB.registerFunctionAnalyses(FAM);
  PB.registerLoopAnalyses(LAM);
  PB.crossRegisterProxies(LAM, FAM, CGAM, MAM);
  ModulePassManager MPM;
  MPM.addPass(AlwaysInlinerPass(/*InsertLifetime=*/false));
  MPM.addPass(
      createModuleToFunctionPassAdaptor(SROAPass(SROAOptions::PreserveCFG)));
  MPM.run(M, MAM);
  for (const WeakVH &F : Marked)
    if (F)
      cast<Function>(F)->removeFnAttr(Attribute::AlwaysInline);
}

/// True where \p I only keeps a local variable in memory: promotion takes it
/// away, and what takes its place stands for something else.
static bool isLocalMemory(const Instruction &I) {
  const Value *Pointer = getLoadStorePointerOperand(&I);
  if (!Pointer)
    return isa<AllocaInst>(I);
  while (const auto *GEP = dyn_cast<GEPOperator>(Pointer))
    Pointer = GEP->getPointerOperand();
  return isa<AllocaInst>(Pointer);
}

/// Takes away the marks of -O0.
static void allowOptimisation(Module &M) {
  for (Function &F : M)
    if (F.hasFnAttribute(Attribute::OptimizeNone)) {
      F.removeFnAttr(Attribute::OptimizeNone);
      F.removeFnAttr(Attribute::NoInline);
    }
}

AnalysedModule::AnalysedModule(Module &M, const Options &Opts) : Original(M) {
  bool Unoptimised = any_of(M, [](const Function &F) {
    return F.hasFnAttribute(Attribute::OptimizeNone);
  });
  if (!Unoptimised) {
    prepare(M, Opts);
    return;
  }
  ValueToValueMapTy Map;
  Copy = CloneModule(M, Map);
  allowOptimisation(*Copy);
  prepare(*Copy, Opts);
  // The map follows what promotion replaces; in the order of the program the
  // instruction itself comes before those that it stands in for.
  for (Function &F : M)
    for (Instruction &I : instructions(F))
      if (!isLocalMemory(I))
        if (auto *C = dyn_cast_or_null<Instruction>(Map.lookup(&I));
            C && C->getOpcode() == I.getOpcode())
          Back.try_emplace(C, &I);
}

Value *AnalysedModule::original(Value *V) const {
  if (!Copy || isa<Constant>(V))
    return V;
  return Back.lookup(V);
}

/// A function with more calls, or more instructions, is not copied.
static constexpr unsigned MaxCopies = 16, MaxCopied = 500;

bool separateCalls(Module &M, ArrayRef<std::string> Names) {
  bool Changed = false;
  for (const std::string &Name : Names) {
    Function *F = M.getFunction(Name);
    if (!F || F->isDeclaration() || sizeOf(*F) > MaxCopied)
      continue;
    SmallVector<CallBase *, 8> Calls;
    for (User *U : F->users())
      if (auto *Call = dyn_cast<CallBase>(U);
          Call && Call->getCalledFunction() == F && Call->getFunction() != F)
        Calls.push_back(Call);
    if (Calls.size() < 2 || Calls.size() > MaxCopies)
      continue;
    // The users of a value are in no order that means anything; copies of
    // copies keep the place of their call in their name.
    sort(Calls, [](const CallBase *A, const CallBase *B) {
      auto Place = [](const CallBase *C) {
        const DebugLoc &Loc = C->getDebugLoc();
        return std::make_tuple(C->getFunction()->getName(),
                               Loc ? Loc.getLine() : 0, Loc ? Loc.getCol() : 0);
      };
      return Place(A) < Place(B);
    });
    for (CallBase *Call : drop_begin(Calls)) {
      ValueToValueMapTy Map;
      Function *Copy = CloneFunction(F, Map);
      Copy->setName(F->getName() + ".tpc");
      Copy->setLinkage(GlobalValue::InternalLinkage);
      Copy->setVisibility(GlobalValue::DefaultVisibility);
      Copy->setComdat(nullptr);
      Call->setCalledFunction(Copy);
      Changed = true;
    }
  }
  return Changed;
}

PreservedAnalyses PreparePass::run(Module &M, ModuleAnalysisManager &) {
  allowOptimisation(M);
  prepare(M, Options::fromCommandLine());
  return PreservedAnalyses::none();
}

} // namespace tpc
