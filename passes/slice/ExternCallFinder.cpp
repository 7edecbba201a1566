//===- ExternCallFinder.cpp -----------------------------------------------===//
#include "slice/ExternCallFinder.h"

#include "memory/PointsTo.h"
#include "memory/Variables.h"
#include "params/Texts.h"
#include "slice/KeptObjects.h"
#include "support/Names.h"
#include "support/Print.h"

#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

AnalysisKey ExternCallFinder::Key;

/// A publisher or client that got a name: where it is stored, and the name.
struct NamedObject {
  Location Where;
  std::string Topic;
};

/// The publishers and clients of \p M. `advertise` returns its result into a
/// temporary or variable. From a temporary, the assignment passes the name on:
/// a call that gets both the temporary and another object.
static SmallVector<NamedObject, 0> namedObjects(Module &M,
                                                const RuleMatches &Rules,
                                                PointsTo &Pointers,
                                                Texts &Known) {
  SmallVector<NamedObject, 0> Found;
  forEachCall(M, Rules, Rule::Topic, [&](CallBase &Call, const Rule &Row) {
    std::string Topic = Known.nameOf(Call, Row);
    if (isDynamic(Topic) || !Call.hasStructRetAttr())
      return;
    Value *Made = Call.getArgOperand(0);
    for (const Location &L : Pointers.resolve(Made, false))
      Found.push_back({L, Topic});
    if (!isa<AllocaInst>(Made))
      return;
    for (User *U : Made->users()) {
      auto *Assign = dyn_cast<CallBase>(U);
      if (!Assign || Assign->arg_size() != 2 ||
          Assign->getArgOperand(1) != Made)
        continue;
      for (const Location &L :
           Pointers.resolve(Assign->getArgOperand(0), false))
        Found.push_back({L, Topic});
    }
  });
  return Found;
}

/// The only topic of \p Object; empty if there is none or more than one.
static std::string topicOf(const Value *Object, ArrayRef<NamedObject> Named,
                           PointsTo &Pointers) {
  std::string Topic;
  if (!Object)
    return Topic;
  for (const Location &L : Pointers.resolve(Object, false))
    for (const NamedObject &N : Named)
      if (L.mayBe(N.Where)) {
        if (!Topic.empty() && Topic != N.Topic)
          return "";
        Topic = N.Topic;
      }
  return Topic;
}

/// Adds what \p F, which overrides a function of another library, gives back.
static void addGivenBack(Function &F, ExternCallFinder::Result &Out) {
  std::string Name = qualifiedName(linkageName(F));
  auto Add = [&](ReturnInst &At, const Argument *Arg) {
    std::string What =
        Arg && !Arg->hasStructRetAttr() ? localName(*Arg, F) : "";
    std::string Topic =
        (unscoped(Name) + " -> " + (What.empty() ? "result" : What)).str();
    Out.push_back({&At, Name, std::move(Topic), Arg});
  };
  for (BasicBlock &BB : F) {
    auto *Return = dyn_cast<ReturnInst>(BB.getTerminator());
    if (!Return)
      continue;
    if (Return->getReturnValue())
      Add(*Return, nullptr);
    for (const Argument *Arg : writtenArguments(F))
      Add(*Return, Arg);
  }
}

ExternCallFinder::Result ExternCallFinder::run(Module &M,
                                               ModuleAnalysisManager &AM) {
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  PointsTo &Pointers = AM.getResult<PointsToAnalysis>(M);
  Texts Known(Rules, AM.getResult<SimpleCallGraph>(M),
              Texts::MemoryView::of(M, AM));
  SmallVector<NamedObject, 0> Named = namedObjects(M, Rules, Pointers, Known);
  Result R;
  forEachCall(M, Rules, Rule::Exposing, [&](CallBase &Call, const Rule &Row) {
    const DILocation *Loc = Call.getDebugLoc();
    if (const DISubprogram *In =
            Loc ? Loc->getScope()->getSubprogram() : nullptr;
        In && Rules.isSilent(*In))
      return;
    std::string Topic = Row.Name
                            ? Known.nameOf(Call, Row)
                            : topicOf(objectOf(Call, Row), Named, Pointers);
    R.push_back({&Call, Row.Function, isDynamic(Topic) ? "" : std::move(Topic),
                 nullptr,
                 /*IsCall=*/true});
  });
  const OverridingFunctions Overriding =
      overridingFunctions(M, AM.getResult<SimpleCallGraph>(M), Rules,
                          AM.getResult<OptionsAnalysis>(M));
  for (Function *F : Overriding.Functions)
    addGivenBack(*F, R);
  SmallVector<InheritedWrite, 0> Writes = inheritedWrites(M, Overriding);
  Writes.append(
      keptObjectWrites(M, AM.getResult<SimpleCallGraph>(M), Rules,
                       AM.getResult<DebugTypesAnalysis>(M), Overriding,
                       UserSources(AM.getResult<OptionsAnalysis>(M))));
  for (InheritedWrite &W : Writes) {
    std::string Name = qualifiedName(linkageName(*W.I->getFunction()));
    std::string Topic = (unscoped(Name) + " -> " + W.Class).str();
    R.push_back({W.I, std::move(Name), std::move(Topic)});
  }
  return R;
}

PreservedAnalyses ExternCallFinderPrinter::run(Module &M,
                                               ModuleAnalysisManager &AM) {
  const auto &R = AM.getResult<ExternCallFinder>(M);
  OS << "exposing statements of " << M.getName() << ": " << R.size() << '\n';
  for (const ExposingStatement &E : R)
    OS << "  " << E.Api << " topic '" << E.Topic << "' in "
       << E.At->getFunction()->getName() << place(*E.At) << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
