//===- ExternCallFinder.cpp -----------------------------------------------===//
#include "slice/ExternCallFinder.h"

#include "memory/PointsTo.h"
#include "memory/Variables.h"
#include "params/Callbacks.h"
#include "params/Texts.h"
#include "slice/KeptObjects.h"
#include "support/DebugTypes.h"
#include "support/Names.h"
#include "support/Print.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/ADT/StringSet.h"
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

namespace {

/// Follows a publisher or client back to the calls that made it: through
/// variables, such as the pointer in a std::shared_ptr, arguments and results.
class MakerSearch {
public:
  MakerSearch(const RuleMatches &Rules, const CallGraphResult &Calls,
              VisibleWrites &Writes, Texts &Known)
      : Rules(Rules), Calls(Calls), Writes(Writes), Known(Known) {}

  /// The only topic of \p Object; empty if there is none or more than one.
  std::string topicOf(const Value *Object);

private:
  void step(const Value *V);
  void add(const CallBase &Call);
  void push(const Value *V) {
    if (Seen.insert(V).second)
      Work.push_back(V);
  }

  const RuleMatches &Rules;
  const CallGraphResult &Calls;
  VisibleWrites &Writes;
  Texts &Known;
  SmallVector<const Value *, 16> Work;
  SmallPtrSet<const Value *, 16> Seen;
  StringSet<> Topics;
};

} // namespace

/// A publisher that may come from more places is none of one topic.
static constexpr unsigned MaxMakers = 256;

/// Adds the topic of what \p Call makes, or goes on to what it returns.
void MakerSearch::add(const CallBase &Call) {
  if (const Rule *Row = Rules.match(Call); Row && Row->Kind == Rule::Topic) {
    Topics.insert(Known.nameOf(Call, *Row));
    return;
  }
  for (const Function *F : Calls.callees(Call))
    for (const BasicBlock &BB : *F)
      if (const auto *Return = dyn_cast<ReturnInst>(BB.getTerminator());
          Return && Return->getReturnValue())
        push(Return->getReturnValue());
}

void MakerSearch::step(const Value *V) {
  if (const auto *Load = dyn_cast<LoadInst>(V)) {
    for (const Instruction *Write : Writes.definitionsOf(*Load))
      if (const auto *Store = dyn_cast<StoreInst>(Write))
        push(Store->getValueOperand());
      else if (const auto *Call = dyn_cast<CallBase>(Write);
               Call && Call->hasStructRetAttr() &&
               PointsTo::baseOf(Load->getPointerOperand()) ==
                   PointsTo::baseOf(Call->getArgOperand(0)))
        add(*Call);
  } else if (const auto *Arg = dyn_cast<Argument>(V)) {
    for (const CallBase *Call : Calls.callers(Arg->getParent()))
      if (Arg->getArgNo() < Call->arg_size())
        push(Call->getArgOperand(Arg->getArgNo()));
  } else if (const auto *Call = dyn_cast<CallBase>(V)) {
    add(*Call);
  } else if (isa<PHINode, SelectInst, CastInst, FreezeInst>(V) ||
             (isa<GEPOperator>(V) &&
              cast<GEPOperator>(V)->hasAllZeroIndices())) {
    for (const Value *From : cast<User>(V)->operands())
      if (From->getType()->isPointerTy())
        push(From);
  }
}

std::string MakerSearch::topicOf(const Value *Object) {
  Work.clear();
  Seen.clear();
  Topics.clear();
  if (Object)
    push(Object);
  while (!Work.empty() && Seen.size() < MaxMakers && Topics.size() < 2)
    step(Work.pop_back_val());
  if (!Work.empty() || Topics.size() != 1)
    return "";
  std::string Topic = Topics.begin()->getKey().str();
  return isDynamic(Topic) ? "" : Topic;
}

/// True if \p Loc is in a function whose messages are about its library.
static bool isSilent(const DILocation *Loc, const RuleMatches &Rules) {
  const DISubprogram *In = Loc ? Loc->getScope()->getSubprogram() : nullptr;
  return In && Rules.isSilent(*In);
}

/// The arguments of \p F that are smart pointers to objects of which the name
/// of the class contains \p Answer.
static SmallVector<const Argument *, 1>
answers(const Function &F, StringRef Answer, DebugTypes &Debug) {
  SmallVector<const Argument *, 1> Found;
  for (const Argument &Arg : F.args()) {
    const DIType *T =
        Answer.empty() ? nullptr : DebugTypes::plain(Debug.pointee(&Arg));
    const auto *Class = dyn_cast_or_null<DICompositeType>(T);
    const DIType *Of = Class && isSmartPointer(Class) && !pointsToConst(Class)
                           ? DebugTypes::plain(firstArgumentOf(*Class))
                           : nullptr;
    if (Of && Of->getName().contains(Answer))
      Found.push_back(&Arg);
  }
  return Found;
}

/// Adds what \p F, which overrides a function of another library, gives back:
/// its result, and the objects at \p Written; or a function that \p CalledBy
/// calls back.
static void addGivenBack(Function &F, ArrayRef<const Argument *> Written,
                         ExternCallFinder::Result &Out,
                         StringRef CalledBy = "") {
  std::string Name =
      CalledBy.empty() ? qualifiedName(linkageName(F)) : CalledBy.str();
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
    for (const Argument *Arg : Written)
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
  MakerSearch Makers(Rules, AM.getResult<SimpleCallGraph>(M),
                     AM.getResult<VisibleWritesAnalysis>(M), Known);
  Result R;
  forEachCall(M, Rules, Rule::Exposing, [&](CallBase &Call, const Rule &Row) {
    if (isSilent(Call.getDebugLoc(), Rules))
      return;
    std::string Topic = Row.Name
                            ? Known.nameOf(Call, Row)
                            : topicOf(objectOf(Call, Row), Named, Pointers);
    if (Topic.empty())
      Topic = Makers.topicOf(objectOf(Call, Row));
    R.push_back({&Call, Row.Function, isDynamic(Topic) ? "" : std::move(Topic),
                 nullptr,
                 /*IsCall=*/true});
  });
  const OverridingFunctions Overriding =
      overridingFunctions(M, AM.getResult<SimpleCallGraph>(M), Rules,
                          AM.getResult<OptionsAnalysis>(M));
  for (Function *F : Overriding.Functions)
    if (!Rules.isSilent(*F->getSubprogram()))
      addGivenBack(*F, writtenArguments(*F), R);
  UserSources Sources(AM.getResult<OptionsAnalysis>(M));
  DebugTypes &Debug = AM.getResult<DebugTypesAnalysis>(M);
  SmallSetVector<Function *, 8> Given = Overriding.Functions;
  forEachCall(M, Rules, Rule::Callback, [&](CallBase &Call, const Rule &Row) {
    for (unsigned N : Row.Callbacks)
      if (const Value *Callback = Row.Name ? nullptr : argument(Call, Row, N))
        for (Function *F : calledBackBy(*Callback, Call, Sources))
          if (Given.insert(F)) {
            SmallVector<const Argument *, 4> Written(writtenArguments(*F));
            append_range(Written, answers(*F, Row.Answer, Debug));
            addGivenBack(*F, Written, R, Row.Function);
          }
  });
  SmallVector<InheritedWrite, 0> Writes = inheritedWrites(M, Overriding);
  Writes.append(keptObjectWrites(M, AM.getResult<SimpleCallGraph>(M), Rules,
                                 AM.getResult<DebugTypesAnalysis>(M),
                                 Overriding, std::move(Sources)));
  for (InheritedWrite &W : Writes) {
    if (isSilent(W.I->getDebugLoc(), Rules))
      continue;
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
