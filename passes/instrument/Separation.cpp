//===- Separation.cpp -----------------------------------------------------===//
#include "instrument/Separation.h"

#include "Rules.h"
#include "support/Functions.h"
#include "support/Names.h"
#include "support/Numbers.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/ADT/Statistic.h"
#include "llvm/Analysis/InlineCost.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/InlineAsm.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/Support/CommandLine.h"
#include "llvm/Support/Debug.h"
#include "llvm/Transforms/Utils/Cloning.h"

using namespace llvm;

#define DEBUG_TYPE "tpc-prepare"
STATISTIC(NumCopied, "Copies of functions for single calls");

namespace tpc {

unsigned sizeOf(const Function &F) {
  return count_if(instructions(F), [](const Instruction &I) {
    return !isa<AssumeInst>(I) && !I.isDebugOrPseudoInst() &&
           !I.isLifetimeStartOrEnd();
  });
}

void callByOwnName(Module &M) {
  for (GlobalAlias &Alias : M.aliases())
    if (auto *F = dyn_cast<Function>(Alias.getAliasee());
        F && !Alias.isInterposable() && !F->isInterposable())
      Alias.replaceUsesWithIf(F, [](const Use &U) {
        const auto *Call = dyn_cast<CallBase>(U.getUser());
        return Call && Call->isCallee(&U);
      });
}

/// True if a copy of \p F can stand for \p F. It cannot if another link unit
/// may hold the definition that counts, if the addresses of labels are taken (a
/// table elsewhere may hold them) or if it contains assembly, which may define
/// symbols.
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

SmallVector<NumberedCall, 8> callsOf(Function &F) {
  SmallPtrSet<CallBase *, 8> Calls;
  SmallPtrSet<Function *, 8> Callers;
  for (User *U : F.users())
    if (auto *Call = dyn_cast<CallBase>(U);
        Call && Call->getCalledFunction() == &F && Call->getFunction() != &F) {
      Calls.insert(Call);
      Callers.insert(Call->getFunction());
    }
  SmallVector<NumberedCall, 8> Ordered;
  if (Calls.empty())
    return Ordered;
  for (Function &Caller : *F.getParent())
    if (Callers.contains(&Caller))
      for (auto [Number, I] : enumerate(numberedInstructions(Caller)))
        if (auto *Call = dyn_cast<CallBase>(&I); Call && Calls.contains(Call))
          Ordered.push_back({Call, static_cast<unsigned>(Number)});
  return Ordered;
}

/// The functions in \p M whose comparisons count as their callers', by name:
/// the order of a module is that of its files, and what is inlined first makes
/// other code of the caller.
static SmallVector<Function *, 8> findTransparent(Module &M,
                                                  const Rules &Tables) {
  SmallVector<Function *, 8> Found;
  for (Function &F : definedFunctions(M)) {
    const DISubprogram *SP = F.getSubprogram();
    if (SP && mayBeCopied(F) &&
        Tables.isTransparent(qualifiedName(SP->getLinkageName())) &&
        isInlineViable(F).isSuccess())
      Found.push_back(&F);
  }
  sort(Found, [](const Function *A, const Function *B) {
    return A->getName() < B->getName();
  });
  return Found;
}

/// Inlines them. True if there are any.
static bool inlineTransparent(Module &M, const Rules &Tables) {
  bool Inlined = false;
  for (Function *F : findTransparent(M, Tables))
    for (const NumberedCall &Of : callsOf(*F)) {
      InlineFunctionInfo Info;
      Inlined |= InlineFunction(*Of.Call, Info, /*MergeAttributes=*/true,
                                /*CalleeAAR=*/nullptr, /*InsertLifetime=*/false)
                     .isSuccess();
    }
  return Inlined;
}

/// The copies stay in the program, so they must not make it noticeably larger.
static cl::opt<unsigned> MaxAdded(
    "tpc-max-added", cl::Hidden, cl::init(50000),
    cl::desc("Instructions that copies of functions may add in one round"));

/// A name for a copy of \p F; \p Number is the number of the last copy. It
/// depends only on the names in the module. LLVM's own suffix for a name in use
/// depends on the history of the module.
static std::string copyName(const Function &F, unsigned &Number) {
  std::string Name;
  do
    Name = (F.getName() + CopyMark + Twine(++Number)).str();
  while (F.getParent()->getNamedValue(Name));
  return Name;
}

Function *cloneAs(const Twine &Name, Function &F, ValueToValueMapTy &Map) {
  Function *Copy = CloneFunction(&F, Map);
  Copy->setName(Name);
  Copy->setLinkage(GlobalValue::InternalLinkage);
  Copy->setVisibility(GlobalValue::DefaultVisibility);
  Copy->setComdat(nullptr);
  return Copy;
}

SmallVector<NumberedCall, 8> Copier::separate(Function *F, bool KeepsOwn) {
  if (!F || !mayBeCopied(*F))
    return {};
  SmallVector<NumberedCall, 8> Calls = callsOf(*F);
  const size_t Kept = KeepsOwn ? 1 : 0;
  if (Calls.size() <= Kept)
    return {};
  const size_t More = (Calls.size() - Kept) * sizeOf(*F);
  if (Added + More > MaxAdded) {
    LLVM_DEBUG(dbgs() << "too large to be copied: " << F->getName() << '\n');
    return {};
  }
  Added += More;
  unsigned Number = 0;
  for (const NumberedCall &Of : drop_begin(Calls, Kept)) {
    ValueToValueMapTy Map;
    Of.Call->setCalledFunction(cloneAs(copyName(*F, Number), *F, Map));
    ++NumCopied;
  }
  return Calls;
}

/// Copies each function of \p Names in \p M for each of its calls.
static std::vector<SeparatedFunction> separateAll(Module &M,
                                                  ArrayRef<std::string> Names) {
  std::vector<SeparatedFunction> Done;
  Copier Round;
  for (const std::string &Name : Names) {
    Function *F = M.getFunction(Name);
    SmallVector<NumberedCall, 8> Calls = Round.separate(F);
    if (!Calls.empty())
      Done.push_back({F, std::move(Calls)});
  }
  return Done;
}

bool Separation::inlineTransparentIn(Module &M) const {
  callByOwnName(M);
  return inlineTransparent(M, Tables);
}

std::vector<SeparatedFunction>
Separation::separateIn(Module &M, std::vector<std::string> Names) {
  std::vector<SeparatedFunction> Done = separateAll(M, Names);
  if (!Done.empty())
    Rounds.push_back(std::move(Names));
  return Done;
}

void Separation::applyTo(Module &M) const {
  inlineTransparentIn(M);
  for (const std::vector<std::string> &Names : Rounds)
    separateAll(M, Names);
}

} // namespace tpc
