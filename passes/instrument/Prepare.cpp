//===- Prepare.cpp --------------------------------------------------------===//
#include "instrument/Prepare.h"

#include "Options.h"
#include "Rules.h"
#include "params/Texts.h"
#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/ADT/Statistic.h"
#include "llvm/Analysis/InlineCost.h"
#include "llvm/IR/DebugInfo.h"
#include "llvm/IR/InlineAsm.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"
#include "llvm/Passes/PassBuilder.h"
#include "llvm/Support/CommandLine.h"
#include "llvm/Support/Debug.h"
#include "llvm/Transforms/IPO/AlwaysInliner.h"
#include "llvm/Transforms/Scalar/SROA.h"
#include "llvm/Transforms/Utils/BasicBlockUtils.h"
#include "llvm/Transforms/Utils/Cloning.h"
#include "llvm/Transforms/Utils/LowerAtomic.h"

using namespace llvm;

#define DEBUG_TYPE "tpc-prepare"
STATISTIC(NumInlined, "Library functions that are inlined to be analysed");
STATISTIC(NumCopied, "Copies of functions for single calls");

namespace tpc {

/// Accessors, iterators and smart pointers are smaller at -O0; larger functions
/// are no part of their caller's line.
static cl::opt<unsigned>
    MaxInlined("tpc-max-inlined", cl::Hidden, cl::init(100),
               cl::desc("Instructions of a library function that is inlined"));

/// The instructions of \p F without the marks that only some levels have.
static unsigned sizeOf(const Function &F) {
  return count_if(instructions(F), [](const Instruction &I) {
    return !isa<AssumeInst>(I) && !I.isDebugOrPseudoInst() &&
           !I.isLifetimeStartOrEnd();
  });
}

/// Marks the small functions of libraries in \p M to be inlined; returns those
/// that were not marked before. What the rules speak of stays a call.
static SmallVector<WeakVH, 0>
markSmallLibraryFunctions(Module &M, const Options &Opts,
                          std::shared_ptr<const Rules> Tables) {
  SmallVector<WeakVH, 0> Marked;
  const RuleMatches Known(std::move(Tables), M);
  UserSources Sources(Opts);
  for (Function &F : definedFunctions(M)) {
    if (!F.getSubprogram() || Sources.has(F) ||
        F.hasFnAttribute(Attribute::AlwaysInline) ||
        F.hasFnAttribute(Attribute::NoInline) || sizeOf(F) > MaxInlined ||
        Known.staysCall(F))
      continue;
    F.addFnAttr(Attribute::AlwaysInline);
    Marked.emplace_back(&F);
  }
  NumInlined += Marked.size();
  return Marked;
}

/// Inlines what is marked to be, and makes values of locals.
static void inlineMarked(Module &M) {
  // Managers of its own: the module is a copy that no other pass sees, and is
  // changed before it is analysed.
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
}

/// Makes loads and stores of what reads and writes memory in one go. That no
/// other thread comes between is nothing to the analysis; that others see what
/// is stored is.
static void takeAtomicsApart(Module &M) {
  for (Function &F : definedFunctions(M))
    for (Instruction &I : make_early_inc_range(instructions(F))) {
      Instruction *After = I.getNextNode();
      if (auto *Update = dyn_cast<AtomicRMWInst>(&I))
        lowerAtomicRMWInst(Update);
      else if (auto *Exchange = dyn_cast<AtomicCmpXchgInst>(&I))
        lowerAtomicCmpXchgInst(Exchange);
      else
        continue;
      Instruction *Last = After->getPrevNode();
      while (!isa<StoreInst>(Last))
        Last = Last->getPrevNode();
      cast<StoreInst>(Last)->setAtomic(AtomicOrdering::SequentiallyConsistent);
    }
}

/// Makes \p M fit for the analysis.
static void prepare(Module &M, const Options &Opts,
                    std::shared_ptr<const Rules> Tables) {
  takeAtomicsApart(M);
  // Only there may a value be computed from itself, and following it back would
  // not end.
  for (Function &F : definedFunctions(M))
    EliminateUnreachableBlocks(F);
  SmallVector<WeakVH, 0> Marked =
      markSmallLibraryFunctions(M, Opts, std::move(Tables));
  inlineMarked(M);
  for (const WeakVH &F : Marked)
    if (F)
      cast<Function>(F)->removeFnAttr(Attribute::AlwaysInline);
}

/// Takes away the marks of -O0.
static void allowOptimisation(Module &M) {
  for (Function &F : M)
    if (F.hasFnAttribute(Attribute::OptimizeNone)) {
      F.removeFnAttr(Attribute::OptimizeNone);
      F.removeFnAttr(Attribute::NoInline);
    }
}

/// Has calls of another name of a function call it by its own: above -O0 the
/// constructors of a class are one function with two names.
static void callByOwnName(Module &M) {
  for (GlobalAlias &Alias : M.aliases())
    if (auto *F = dyn_cast<Function>(Alias.getAliasee());
        F && !Alias.isInterposable() && !F->isInterposable())
      Alias.replaceUsesWithIf(F, [](const Use &U) {
        const auto *Call = dyn_cast<CallBase>(U.getUser());
        return Call && Call->isCallee(&U);
      });
}

/// True where a copy of \p F in place of \p F cannot be told from it: another
/// link unit may have the one that counts, the addresses of labels, which a
/// table outside may hold, stay those of \p F, and assembly may define names.
static bool mayBeCopied(const Function &F) {
  return !F.isDeclarationForLinker() && !F.isInterposable() &&
         none_of(F,
                 [](const BasicBlock &BB) { return BB.hasAddressTaken(); }) &&
         none_of(instructions(F), [](const Instruction &I) {
           const auto *Call = dyn_cast<CallBase>(&I);
           const auto *Assembly =
               Call ? dyn_cast<InlineAsm>(Call->getCalledOperand()) : nullptr;
           return Call && (Call->cannotDuplicate() || Call->isMustTailCall() ||
                           (Assembly && !Assembly->getAsmString().empty()));
         });
}

/// The calls of \p F outside of it, in the order of the module: the users of a
/// value are in none that two copies of a module share.
static SmallVector<CallBase *, 8> callsOf(Function &F) {
  SmallPtrSet<CallBase *, 8> Calls;
  SmallPtrSet<Function *, 8> Callers;
  for (User *U : F.users())
    if (auto *Call = dyn_cast<CallBase>(U);
        Call && Call->getCalledFunction() == &F && Call->getFunction() != &F) {
      Calls.insert(Call);
      Callers.insert(Call->getFunction());
    }
  SmallVector<CallBase *, 8> Ordered;
  if (Calls.empty())
    return Ordered;
  for (Function &Caller : *F.getParent())
    if (Callers.contains(&Caller))
      for (Instruction &I : instructions(Caller))
        if (auto *Call = dyn_cast<CallBase>(&I); Call && Calls.contains(Call))
          Ordered.push_back(Call);
  return Ordered;
}

/// Inlines the functions whose comparisons are their callers' in \p M. True
/// where there are some.
static bool inlineTransparent(Module &M, const Rules &Tables) {
  bool Inlined = false;
  for (Function &F : definedFunctions(M)) {
    const DISubprogram *SP = F.getSubprogram();
    if (!SP || !mayBeCopied(F) ||
        !Tables.isTransparent(qualifiedName(SP->getLinkageName())) ||
        !isInlineViable(F).isSuccess())
      continue;
    for (CallBase *Call : callsOf(F)) {
      InlineFunctionInfo Info;
      Inlined |= InlineFunction(*Call, Info, /*MergeAttributes=*/true,
                                /*CalleeAAR=*/nullptr, /*InsertLifetime=*/false)
                     .isSuccess();
    }
  }
  return Inlined;
}

/// The copies stay in the program: they may not make it noticeably larger.
static cl::opt<unsigned> MaxAdded(
    "tpc-max-added", cl::Hidden, cl::init(50000),
    cl::desc("Instructions that copies of functions may add in one round"));

/// A name for a copy of \p F, after \p Number, the last one's. It depends on
/// the names in the module alone; what LLVM would add to one that is taken
/// depends on how the module came about.
static std::string copyName(const Function &F, unsigned &Number) {
  std::string Name;
  do
    Name = (F.getName() + ".tpc." + Twine(++Number)).str();
  while (F.getParent()->getNamedValue(Name));
  return Name;
}

/// Gives each call of a function of \p Names in \p M a copy of the function, so
/// that what one call hands it is not taken for what another does. True where
/// something was copied.
static bool separateCalls(Module &M, ArrayRef<std::string> Names) {
  bool Changed = false;
  size_t Added = 0;
  for (const std::string &Name : Names) {
    Function *F = M.getFunction(Name);
    if (!F || !mayBeCopied(*F))
      continue;
    SmallVector<CallBase *, 8> Calls = callsOf(*F);
    if (Calls.size() < 2)
      continue;
    size_t More = (Calls.size() - 1) * sizeOf(*F);
    if (Added + More > MaxAdded) {
      LLVM_DEBUG(dbgs() << "too large to be copied: " << Name << '\n');
      continue;
    }
    Added += More;
    unsigned Number = 0;
    for (CallBase *Call : drop_begin(Calls)) {
      ValueToValueMapTy Map;
      Function *Copy = CloneFunction(F, Map);
      Copy->setName(copyName(*F, Number));
      Copy->setLinkage(GlobalValue::InternalLinkage);
      Copy->setVisibility(GlobalValue::DefaultVisibility);
      Copy->setComdat(nullptr);
      Call->setCalledFunction(Copy);
      Changed = true;
      ++NumCopied;
    }
  }
  return Changed;
}

Separation::Effect Separation::applyTo(Module &M) const {
  callByOwnName(M);
  Effect Done;
  Done.Any = inlineTransparent(M, Tables);
  for (const std::vector<std::string> &Names : Rounds) {
    Done.LastRound = separateCalls(M, Names);
    Done.Any |= Done.LastRound;
  }
  return Done;
}

//===----------------------------------------------------------------------===//
// The copy that is analysed
//===----------------------------------------------------------------------===//

/// Has a copy of \p M share its debug information: nothing changes it, and to
/// copy it takes longer than to copy the program.
static void shareDebugInfo(const Module &M, ValueToValueMapTy &Map) {
  DebugInfoFinder Finder;
  Finder.processModule(M);
  auto Share = [&](auto Nodes) {
    for (MDNode *N : Nodes)
      Map.MD()[N].reset(N);
  };
  Share(Finder.compile_units());
  Share(Finder.subprograms());
  Share(Finder.types());
  Share(Finder.scopes());
}

AnalysedModule::AnalysedModule(Module &M, const Options &Opts,
                               std::shared_ptr<const Rules> All)
    : M(M), Opts(Opts), Tables(std::move(All)), Calls(*Tables) {
  copy();
  prepareCopy();
}

bool AnalysedModule::copy() {
  // Not on the stack: a crash below leaves this function without unwinding, and
  // the values of M know the map.
  auto Map = std::make_unique<ValueToValueMapTy>();
  shareDebugInfo(M, *Map);
  std::unique_ptr<Module> Next = CloneModule(M, *Map);
  Separation::Effect Done = Calls.applyTo(*Next);
  if (!Copy || Done.LastRound) {
    Instructions.clear();
    Opcodes.clear();
    Copy = std::move(Next);
    IsSeparated = Done.Any;
  }
  return Done.LastRound;
}

void AnalysedModule::prepareCopy() {
  // A handle that is moved takes itself out of a list and into it again.
  Instructions.reserve(Copy->getInstructionCount());
  Opcodes.reserve(Instructions.capacity());
  for (Function &F : *Copy)
    for (Instruction &I : instructions(F)) {
      Instructions.emplace_back(&I);
      Opcodes.push_back(I.getOpcode());
    }
  allowOptimisation(*Copy);
  prepare(*Copy, Opts, Tables);
}

bool AnalysedModule::separate(std::vector<std::string> Names) {
  if (Names.empty())
    return false;
  Calls.add(std::move(Names));
  if (!copy()) {
    Calls.removeLast();
    return false;
  }
  prepareCopy();
  return true;
}

bool AnalysedModule::bringBack() {
  if (IsSeparated)
    Calls.applyTo(M);
  std::vector<Instruction *> There;
  for (Function &F : M)
    for (Instruction &I : instructions(F))
      There.push_back(&I);
  if (!equal(There, Opcodes, [](const Instruction *I, unsigned Opcode) {
        return I->getOpcode() == Opcode;
      }))
    return false;
  SmallPtrSet<const Value *, 0> Promoted;
  for (auto [I, Now] : zip_equal(There, Instructions))
    if (isa<AllocaInst>(I) && !Now)
      Promoted.insert(I);
  // What only keeps a local in memory that promotion took away has nothing that
  // corresponds to it: what took its place stands for something else.
  auto IsPromoted = [&](const Instruction &I) {
    const Value *Pointer = getLoadStorePointerOperand(&I);
    while (const auto *GEP = dyn_cast_or_null<GEPOperator>(Pointer))
      Pointer = GEP->getPointerOperand();
    return Pointer && Promoted.contains(Pointer);
  };
  // In the order of the program an instruction itself comes before those that
  // it stands in for.
  for (auto [I, Handle] : zip_equal(There, Instructions)) {
    Value *Now = Handle;
    if (auto *C = dyn_cast_or_null<Instruction>(Now);
        C && !IsPromoted(*I) &&
        (C->getOpcode() == I->getOpcode() ||
         (isa<AtomicRMWInst>(I) && isa<LoadInst>(C))))
      Back.try_emplace(C, I);
  }
  return true;
}

Value *AnalysedModule::original(Value *V) const {
  if (isa<Constant>(V))
    return V;
  return Back.lookup(V);
}

std::vector<std::string> namedByCalls(Module &M, ModuleAnalysisManager &AM) {
  const RuleMatches &Known = AM.getResult<RuleAnalysis>(M);
  Texts Names(Known, AM.getResult<SimpleCallGraph>(M), std::nullopt);
  forEachCall(M, Known, Rule::Read, [&](CallBase &Call, const Rule &Row) {
    Names.nameOf(Call, Row);
  });
  std::vector<std::string> Found;
  for (const Function *F : Names.shared())
    Found.push_back(F->getName().str());
  return Found;
}

PreservedAnalyses PreparePass::run(Module &M, ModuleAnalysisManager &AM) {
  const RuleTables &Rules = AM.getResult<RuleTableAnalysis>(M);
  if (!Rules.Error.empty())
    M.getContext().emitError("tpc: " + Rules.Error);
  allowOptimisation(M);
  callByOwnName(M);
  prepare(M, AM.getResult<OptionsAnalysis>(M), Rules.Tables);
  separateCalls(M, namedByCalls(M, AM));
  return PreservedAnalyses::none();
}

} // namespace tpc
