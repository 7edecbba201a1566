//===- Explain.cpp --------------------------------------------------------===//
#include "results/Explain.h"

#include "control/Throws.h"
#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/IR/IntrinsicInst.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

/// People read the beginning and the end of a longer path.
static cl::opt<unsigned>
    MaxSteps("tpc-max-path-steps", cl::Hidden, cl::init(32),
             cl::desc("Steps of a path that are written before the predicate, "
                      "and behind it"));
/// Limits the size of the file of a link unit with very many comparisons: their
/// paths are shortened further.
static cl::opt<unsigned> MaxStepsOfUnit(
    "tpc-max-unit-path-steps", cl::Hidden, cl::init(10000),
    cl::desc("Steps of all paths of a link unit that are written"));
/// A shortened path keeps the first step, the last, and a step for the gap.
static constexpr unsigned MinSteps = 3;

size_t Explainer::stepsFor(size_t NumComparisons) {
  size_t Share = MaxStepsOfUnit / (2 * std::max<size_t>(NumComparisons, 1));
  return std::clamp<size_t>(Share, MinSteps,
                            std::max(MinSteps, MaxSteps.getValue()));
}

StringRef PathStep::kindName() const {
  static constexpr StringRef Names[] = {
      "load",    "compute", "store",   "pass", "return", "call",   "value",
      "control", "decide",  "compare", "read", "expose", "omitted"};
  return Names[Kind];
}

/// Appends \p S to \p Out, or adds it to the last step if both are on the same
/// line.
static void join(std::vector<PathStep> &Out, PathStep S) {
  PathStep *Last = Out.empty() ? nullptr : &Out.back();
  if (!Last || !Last->Loc || !S.Loc || Last->Kind == PathStep::Omitted ||
      Last->Loc->getFile() != S.Loc->getFile() ||
      Last->Loc->getLine() != S.Loc->getLine())
    return Out.push_back(std::move(S));
  // Steps that are obvious from the line need no words beside the others.
  auto IsPlain = [](const PathStep &P) { return P.Kind <= PathStep::Compute; };
  if (IsPlain(*Last) || Last->What.empty())
    Last->What = std::move(S.What);
  else if (!IsPlain(S) && !S.What.empty() && Last->What != S.What &&
           !StringRef(Last->What).ends_with("; " + S.What))
    Last->What += "; " + S.What;
  if (S.Kind > Last->Kind) {
    Last->Kind = S.Kind;
    Last->Loc = S.Loc;
    Last->Unit = S.Unit;
  }
}

/// The link unit that has the line \p Loc of \p I, which may be inlined from a
/// function of another unit.
StringRef Explainer::unitOf(const Instruction &I, const DILocation *Loc) {
  const Function *In = I.getFunction();
  if (!In->hasFnAttribute(UnitMark)) // not a process
    return "";
  const DISubprogram *SP = Loc ? Loc->getScope()->getSubprogram() : nullptr;
  if (SP && Functions.empty())
    for (const Function &F : *In->getParent())
      if (F.getSubprogram() && F.hasFnAttribute(UnitMark))
        Functions.try_emplace(F.getSubprogram(), &F);
  if (const Function *Own = Functions.lookup(SP))
    In = Own;
  return In->getFnAttribute(UnitMark).getValueAsString();
}

/// A step inside a library belongs to the line of user code that it runs for.
void Explainer::add(Steps &Out, PathStep::KindTy Kind, const Instruction &I,
                    std::string What) {
  const DILocation *Loc = Words.userPlace(I);
  bool IsEnd = Kind == PathStep::Read || Kind == PathStep::Expose;
  if (!Loc && IsEnd)
    Loc = I.getDebugLoc();
  if (Loc || IsEnd)
    join(Out, {Kind, Loc, std::move(What), unitOf(I, Loc)});
}

std::string Explainer::compared(const Comparison &C) const {
  std::string Other = Words.value(C.Compare->getOperand(1 - C.Threshold));
  std::string Limit = Words.value(C.Compare->getOperand(C.Threshold));
  std::string Text = "compared: " + (Other.empty() ? "a value" : Other) + " " +
                     C.relation().str() + " ";
  const std::string &Parameter = Reads[C.Reads.front()].Name;
  if (C.How.kind() == Transform::None)
    return Text + (Limit.empty() ? Parameter : Limit);
  Text += Limit.empty() ? C.How.text() : Limit + " (" + C.How.text() + ")";
  return Text + ", x being " + Parameter;
}

/// If \p Load's function got the variable at \p Pointer by reference, the value
/// came through memory, but the source has a call.
void Explainer::byReference(const Value *Pointer, const LoadInst &Load,
                            Steps &Out) {
  const auto *Arg = dyn_cast<Argument>(Load.getPointerOperand());
  if (!Arg || !Pointer)
    return;
  std::string Written = Words.variable(Pointer);
  for (const CallBase *Call : Calls.callers(Arg->getParent()))
    if (Arg->getArgNo() < Call->arg_size() &&
        Words.variable(Call->getArgOperand(Arg->getArgNo())) == Written)
      return add(Out, PathStep::Pass, *Call,
                 Wording::with("handed to " + shortName(*Arg->getParent()),
                               "as", Words.argument(*Arg)));
}

/// One hop on the path from the read to the predicate.
void Explainer::hop(const Hop &H, const Comparison &C, bool IsOutcome,
                    Steps &Out) {
  const auto *To = dyn_cast<Instruction>(H.To);
  std::string Outcome = IsOutcome ? "outcome " : "";
  if (C.Compare && To == C.Compare)
    return add(Out, PathStep::Compare, *To, compared(C));
  if (const auto *Store = dyn_cast<StoreInst>(H.Via)) {
    add(Out, PathStep::Store, *Store,
        Wording::with(Outcome + "stored", "into",
                      Words.variable(Store->getPointerOperand())));
  } else if (const auto *Arg = dyn_cast<Argument>(H.To)) {
    const auto &Call = *cast<CallBase>(H.Via);
    add(Out, PathStep::Pass, Call,
        Wording::with(Outcome + "handed to " + shortName(*Arg->getParent()),
                      "as", Words.argument(*Arg)));
  } else if (isa<ReturnInst>(H.Via)) {
    add(Out, PathStep::Return, *H.Via,
        Outcome + "returned by " + shortName(*H.Via->getFunction()));
  } else if (To == H.Via && !IsOutcome &&
             (isa<BinaryOperator>(To) || isa<UnaryOperator>(To) ||
              isa<CallBase>(To))) {
    add(Out, PathStep::Compute, *To, "computed with");
  }
  if (const auto *Load = dyn_cast<LoadInst>(H.To)) {
    const auto *Store = dyn_cast<StoreInst>(H.Via);
    byReference(Store ? Store->getPointerOperand()
                      : Reads[C.Reads.front()].Target,
                *Load, Out);
    add(Out, PathStep::Load, *Load,
        Wording::with("loaded", "from",
                      Words.variable(Load->getPointerOperand())));
  }
}

Explainer::Steps Explainer::forward(const Comparison &C) {
  Steps Out;
  const ParameterRead &Read = Reads[C.Reads.front()];
  add(Out, PathStep::Read, *Read.Call,
      Wording::with(Read.Name + " read", "into",
                    Read.Target ? Words.variable(Read.Target) : ""));
  bool IsOutcome = false;
  for (const Hop &H : Usage.pathTo(C.Way)) {
    if (H.Via != Read.Call || isa<LoadInst>(H.To))
      hop(H, C, IsOutcome, Out);
    IsOutcome |= isa<CmpInst>(H.To);
  }
  if (C.Predicate == C.Compare) // its outcome is exposed
    add(Out, PathStep::Compare, *C.Compare, compared(C));
  return Out;
}

/// One step on the path from the predicate to the exposing statement.
void Explainer::dependence(const SliceStep &S, const SliceStep &Next,
                           bool IsFirst, Steps &Out) {
  auto Add = [&](PathStep::KindTy Kind, std::string What) {
    add(Out, Kind, *S.I, std::move(What));
  };
  // A call that may throw decides like a predicate.
  std::string How;
  if (const auto *Call = dyn_cast<CallBase>(S.I))
    How = " by whether " + calleeName(*Call) + " throws";
  switch (S.Why) {
  case SliceStep::Controls: {
    if (isThrow(*Next.I))
      return Add(IsFirst ? PathStep::Decide : PathStep::Control,
                 "decides whether " + shortName(*Next.I->getFunction()) +
                     " throws");
    std::string Guarded = Words.guarded(*Next.I);
    const DILocation *Here = Words.userPlace(*S.I);
    bool SameLine =
        Here && Guarded == "line " + std::to_string(Here->getLine());
    return Add(IsFirst ? PathStep::Decide : PathStep::Control,
               Guarded.empty() || SameLine ? "" : "guards " + Guarded + How);
  }
  case SliceStep::Chooses: {
    std::string Name = Words.value(Next.I);
    return Add(IsFirst ? PathStep::Decide : PathStep::Value,
               (!Name.empty() ? "chooses the value of " + Name
                : Next.I->getType()->isIntegerTy(1) ? "chooses the outcome"
                                                    : "chooses a value") +
                   How);
  }
  case SliceStep::Throws:
    return Add(PathStep::Return,
               isThrow(*S.I)
                   ? "thrown by " + shortName(*S.I->getFunction())
                   : "let through by " + shortName(*S.I->getFunction()));
  case SliceStep::Calls:
    return Add(PathStep::Call, "calls " + shortName(*Next.I->getFunction()));
  case SliceStep::Mentions:
    return Add(PathStep::Call,
               "has " + shortName(*Next.I->getFunction()) + " called");
  case SliceStep::Passes:
    return Add(PathStep::Pass,
               "handed to " + shortName(*Next.I->getFunction()));
  case SliceStep::Returns:
    return Add(PathStep::Return,
               "returned by " + shortName(*S.I->getFunction()));
  case SliceStep::Writes:
    if (const auto *Store = dyn_cast<StoreInst>(S.I))
      return Add(PathStep::Store,
                 Wording::with("stored", "into",
                               Words.variable(Store->getPointerOperand())));
    if (const auto *Copy = dyn_cast<MemTransferInst>(S.I))
      return Add(
          PathStep::Store,
          Wording::with("copied", "to", Words.object(Copy->getRawDest())));
    return Add(PathStep::Store,
               "written by " + calleeName(*cast<CallBase>(S.I)));
  case SliceStep::Gives:
    if (const auto *Load = dyn_cast<LoadInst>(S.I))
      return Add(PathStep::Load,
                 Wording::with("loaded", "from",
                               Words.variable(Load->getPointerOperand())));
    if (const auto *Call = dyn_cast<CallBase>(S.I);
        Call && !isMultiplyAdd(*Call))
      return Add(PathStep::Compute, "result of " + calleeName(*Call));
    if (!isa<PHINode>(S.I))
      Add(PathStep::Compute, "computed with");
    return;
  case SliceStep::Exposes:
    return;
  }
}

Explainer::Steps Explainer::backward(const Comparison &C) {
  Steps Out;
  SmallVector<SliceStep, 16> Path = Slice.pathOf(C.Slice);
  for (size_t N = 0; N + 1 < Path.size(); ++N)
    dependence(Path[N], Path[N + 1], /*IsFirst=*/N == 0, Out);
  add(Out, PathStep::Expose, *Path.back().I,
      Words.exposed(Exposing[C.Slice.Exposing]));
  return Out;
}

/// Keeps the first and the last steps of \p Path if there are more than
/// \p Most.
static void shorten(std::vector<PathStep> &Path, size_t Most) {
  if (Path.size() <= Most)
    return;
  size_t Left = Path.size() - Most + 1;
  auto From = Path.begin() + static_cast<ptrdiff_t>(Most / 2);
  *From = {PathStep::Omitted, nullptr,
           std::to_string(Left) + " steps left out"};
  Path.erase(From + 1, From + static_cast<ptrdiff_t>(Left));
}

std::vector<PathStep> Explainer::path(const Comparison &C, size_t Most) {
  Steps All = forward(C), Rest = backward(C);
  shorten(All, Most);
  shorten(Rest, Most);
  for (PathStep &S : Rest)
    join(All, std::move(S));
  for (PathStep &S : All)
    if (S.What.empty())
      S.What = "decides the branch";
  return All;
}

} // namespace tpc
