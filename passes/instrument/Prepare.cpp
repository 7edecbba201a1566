//===- Prepare.cpp --------------------------------------------------------===//
#include "instrument/Prepare.h"

#include "Options.h"
#include "Rules.h"
#include "instrument/HeldNumbers.h"
#include "instrument/NeverRun.h"
#include "instrument/VirtualRules.h"
#include "params/ParameterObjects.h"
#include "params/Texts.h"
#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/ADT/Statistic.h"
#include "llvm/IR/DebugInfo.h"
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
STATISTIC(NumPrepared, "Times that a copy of the program was prepared");

namespace tpc {

/// Accessors, iterators and smart pointers are smaller than this at -O0. A
/// larger function is not part of its caller's line.
static cl::opt<unsigned>
    MaxInlined("tpc-max-inlined", cl::Hidden, cl::init(100),
               cl::desc("Instructions of a library function that is inlined"));

/// Marks the small library functions in \p M for inlining; returns those that
/// were not marked before. Functions that a rule describes stay calls.
static SmallVector<WeakVH, 0>
markSmallLibraryFunctions(Module &M, const Options &Opts,
                          const RuleMatches &Known) {
  SmallVector<WeakVH, 0> Marked;
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

/// Inlines the functions \p Marked, and others that must be inlined, and
/// promotes locals to values.
static void inlineMarked(Module &M, ArrayRef<WeakVH> Marked) {
  // It has managers of its own: no other pass sees the module, a copy, and it
  // is changed before it is analysed.
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
  SROAPass Promote(SROAOptions::PreserveCFG);
  // Each is inlined many times: without its locals it is half as long.
  for (const WeakVH &F : Marked)
    FAM.invalidate(*cast<Function>(F), Promote.run(*cast<Function>(F), FAM));
  ModulePassManager MPM;
  MPM.addPass(AlwaysInlinerPass(/*InsertLifetime=*/false));
  MPM.addPass(createModuleToFunctionPassAdaptor(std::move(Promote)));
  MPM.run(M, MAM);
}

/// Replaces atomic read-modify-write instructions by a load and a store. The
/// analysis does not need the atomicity; it needs that other threads see the
/// stored value.
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

/// Only in unreachable code may a value be computed from itself; following such
/// a value back would never end.
static void removeUnreachable(Module &M) {
  for (Function &F : definedFunctions(M))
    EliminateUnreachableBlocks(F);
}

/// Marks the calls in \p M that return the text or list of a parameter: what
/// they lead to has no other name in the program.
static void markOwnObjects(Module &M, const RuleMatches &Known) {
  forEachCall(M, Known, Rule::Accessor, [&](CallBase &Call, const Rule &Row) {
    if (Call.getType()->isPointerTy() &&
        isObjectType(accessedType(*Call.getCalledFunction(), Row), Known))
      Call.setMetadata(OwnObjectName, MDNode::get(M.getContext(), {}));
  });
}

/// Makes \p M ready for the analysis.
static void prepare(Module &M, const Options &Opts,
                    std::shared_ptr<const Rules> Tables) {
  takeAtomicsApart(M);
  removeUnreachable(M);
  const RuleMatches Known(Tables, M);
  exposeHeldNumbers(M, Known);
  SmallVector<WeakVH, 0> Marked = markSmallLibraryFunctions(M, Opts, Known);
  inlineMarked(M, Marked);
  removeNeverRun(M);
  nameVirtualCalls(M, *Tables);
  markOwnObjects(M, Known);
  // What follows the call of a function that always throws.
  removeUnreachable(M);
  for (const WeakVH &F : Marked)
    if (F)
      cast<Function>(F)->removeFnAttr(Attribute::AlwaysInline);
}

/// Removes the attributes of -O0.
static void allowOptimisation(Module &M) {
  for (Function &F : M)
    if (F.hasFnAttribute(Attribute::OptimizeNone)) {
      F.removeFnAttr(Attribute::OptimizeNone);
      F.removeFnAttr(Attribute::NoInline);
    }
}

//===----------------------------------------------------------------------===//
// The copy that is analysed
//===----------------------------------------------------------------------===//

/// Lets the copy of \p M share its debug information: nothing changes it, and
/// copying it takes longer than copying the program.
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

static std::unique_ptr<Module> copyOf(const Module &M) {
  // Allocated on the heap: after a crash this function is left without
  // unwinding, and the values of M refer to the map.
  auto Map = std::make_unique<ValueToValueMapTy>();
  shareDebugInfo(M, *Map);
  return CloneModule(M, *Map);
}

AnalysedModule::AnalysedModule(Module &M, const Options &Opts,
                               std::shared_ptr<const Rules> All)
    : M(M), Opts(Opts), Tables(std::move(All)), Calls(*Tables),
      Plain(copyOf(M)) {
  IsSeparated = Calls.inlineTransparentIn(*Plain);
  prepareCopy();
}

void AnalysedModule::prepareCopy() {
  ++NumPrepared;
  Numbers.number(*Plain);
  Instructions.clear();
  Copy = copyOf(*Plain);
  Opcodes.clear();
  Begins.clear();
  // Moving a handle removes it from a list and adds it again.
  Instructions.reserve(Copy->getInstructionCount());
  Opcodes.reserve(Instructions.capacity());
  for (auto [There, F] : zip_equal(*Plain, *Copy)) {
    Begins[&There] = Instructions.size();
    for (Instruction &I : instructions(F)) {
      Instructions.emplace_back(&I);
      Opcodes.push_back(I.getOpcode());
    }
  }
  allowOptimisation(*Copy);
  prepare(*Copy, Opts, Tables);
}

bool AnalysedModule::separate(std::vector<std::string> Names,
                              function_ref<void()> BeforeChange) {
  std::vector<SeparatedFunction> Done =
      Calls.separateIn(*Plain, std::move(Names));
  if (Done.empty())
    return false;
  IsSeparated = true;
  std::vector<CopiedFunction> &Round = Copied.emplace_back();
  for (const SeparatedFunction &One : Done) {
    Round.push_back({One.From->getName().str(), {}});
    for (const NumberedCall &Of : One.Calls)
      Round.back().Calls.push_back(
          {Of.Call->getFunction()->getName().str(), Of.Number,
           Of.Call->getCalledFunction()->getName().str()});
  }
  BeforeChange();
  if (!repeatInCopy(Done))
    prepareCopy();
  return true;
}

/// Does in the prepared copy what was done in the other one: to prepare it anew
/// takes several times as long. False if that would not be the same.
bool AnalysedModule::repeatInCopy(ArrayRef<SeparatedFunction> Done) {
  if (!all_of(Done,
              [&](const SeparatedFunction &One) { return repeatInCopy(One); }))
    return false;
  // Arguments that had several values may have one in each copy.
  removeNeverRun(*Copy);
  return true;
}

bool AnalysedModule::repeatInCopy(const SeparatedFunction &Of) {
  Function *From = Copy->getFunction(Of.From->getName());
  if (!From || From->isDeclaration())
    return false;
  DenseMap<unsigned, Function *> CalleeOf;
  SmallPtrSet<const Function *, 8> Alike = {From};
  for (const NumberedCall &One : Of.Calls) {
    Function *There = One.Call->getCalledFunction(), *Here = From;
    if (There != Of.From) {
      ValueToValueMapTy Map;
      Here = cloneAs(There->getName(), *From, Map);
      Begins[There] = Instructions.size();
      if (!addHandles(*Of.From, Map))
        return false;
      Numbers.renew(*There, *Here);
      Alike.insert(Here);
    }
    CalleeOf[CallNumbers::of(*One.Call)] = Here;
  }
  SmallVector<CallBase *, 8> Found;
  for (Use &U : From->uses())
    if (auto *Call = dyn_cast<CallBase>(U.getUser());
        Call && Call->isCallee(&U) && !Alike.contains(Call->getFunction()))
      Found.push_back(Call);
  DenseSet<unsigned> Served;
  for (CallBase *Call : Found) {
    auto It = CalleeOf.find(CallNumbers::of(*Call));
    if (It == CalleeOf.end())
      return false;
    Served.insert(It->first);
    Call->setCalledFunction(It->second);
  }
  // A call that was inlined with its function does not have its number.
  return Served.size() == CalleeOf.size();
}

/// Adds the instructions of a copy of \p From, a function of Plain. In the
/// prepared copy, \p Map has its values. False if one is missing.
bool AnalysedModule::addHandles(const Function &From, ValueToValueMapTy &Map) {
  const size_t Begin = Begins.at(&From),
               End = Begin + std::distance(inst_begin(From), inst_end(From));
  for (size_t N = Begin; N != End; ++N) {
    Value *V = Instructions[N];
    if (V && !isa<Constant>(V) && !(V = Map.lookup(V)))
      return false;
    Instructions.emplace_back(V);
    Opcodes.push_back(Opcodes[N]);
  }
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
  // An instruction that only kept a promoted local in memory has no
  // counterpart: its replacement stands for something else.
  auto IsPromoted = [&](const Instruction &I) {
    const Value *Pointer = getLoadStorePointerOperand(&I);
    while (const auto *GEP = dyn_cast_or_null<GEPOperator>(Pointer))
      Pointer = GEP->getPointerOperand();
    return Pointer && Promoted.contains(Pointer);
  };
  // exposeHeldNumbers() writes what these calls do as instructions.
  auto IsHeld = [&](const Instruction &I) {
    const auto *Call = dyn_cast<CallBase>(&I);
    const Function *F = Call ? Call->getCalledFunction() : nullptr;
    const Rule *Row = F ? Tables->match(*F).Row : nullptr;
    return Row && Row->Kind == Rule::Held;
  };
  // In the order of the program, an instruction comes before those that it
  // replaces.
  for (auto [I, Handle] : zip_equal(There, Instructions)) {
    Value *Now = Handle;
    if (auto *C = dyn_cast_or_null<Instruction>(Now);
        C && !IsPromoted(*I) &&
        (C->getOpcode() == I->getOpcode() ||
         (isa<AtomicRMWInst>(I) && isa<LoadInst>(C)) ||
         (isa<FCmpInst>(C) && IsHeld(*I))))
      Back.try_emplace(C, I);
  }
  return true;
}

Value *AnalysedModule::original(Value *V) const {
  if (isa<Constant>(V))
    return V;
  return Back.lookup(V);
}

const Rule *AnalysedModule::rowOf(const CallBase &Call) const {
  const Function *F = Call.getCalledFunction();
  return F ? Tables->match(*F).Row : nullptr;
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
  Copier Copies;
  for (const std::string &Name : namedByCalls(M, AM))
    Copies.separate(M.getFunction(Name));
  return PreservedAnalyses::none();
}

} // namespace tpc
