//===- ExternCallFinder.cpp -----------------------------------------------===//
#include "slice/ExternCallFinder.h"

#include "memory/PointsTo.h"
#include "params/Texts.h"
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
    R.push_back({&Call, &Row, isDynamic(Topic) ? "" : std::move(Topic)});
  });
  return R;
}

PreservedAnalyses ExternCallFinderPrinter::run(Module &M,
                                               ModuleAnalysisManager &AM) {
  const auto &R = AM.getResult<ExternCallFinder>(M);
  OS << "exposing statements of " << M.getName() << ": " << R.size() << '\n';
  for (const ExposingStatement &E : R)
    OS << "  " << E.Row->Function << " topic '" << E.Topic << "' in "
       << E.Call->getFunction()->getName() << place(*E.Call) << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
