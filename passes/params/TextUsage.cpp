//===- TextUsage.cpp ------------------------------------------------------===//
#include "params/TextUsage.h"

#include "params/ParamUsageFinder.h"

#include "llvm/IR/Module.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

bool isText(StringRef Type) {
  return Type == "std::string" ||
         Type.starts_with("std::__cxx11::basic_string<char,");
}

/// Each object is compared with all text operands in the link unit.
static cl::opt<unsigned>
    MaxObjects("tpc-max-text-copies", cl::Hidden, cl::init(16),
               cl::desc("Objects that one text is copied to"));

/// A function that copies the text of its arguments, as the methods of messages
/// do, is looked at once for each call.
static cl::opt<unsigned>
    MaxCalls("tpc-max-text-calls", cl::Hidden, cl::init(1024),
             cl::desc("Calls that one copy of a text is told apart by"));
static cl::opt<unsigned>
    MaxCallDepth("tpc-max-text-call-depth", cl::Hidden, cl::init(4),
                 cl::desc("Nested calls that a copy of a text is told apart "
                          "by"));

/// True if \p GEP counts bytes: its place depends on the type of the object.
static bool countsBytes(const GEPOperator *GEP) {
  const auto *T = dyn_cast<StructType>(GEP->getSourceElementType());
  return GEP->getSourceElementType()->isIntegerTy(8) || (T && T->isLiteral());
}

/// The argument that \p P is computed from; null if there is none, or the way
/// from there is not known. Adds that way to \p Steps.
static const Argument *argumentOf(const Value *P,
                                  SmallVectorImpl<const GEPOperator *> &Steps) {
  while (const auto *GEP = dyn_cast<GEPOperator>(P)) {
    if (countsBytes(GEP))
      return nullptr;
    if (!GEP->hasAllZeroIndices() || GEP->getNumIndices() > 1)
      Steps.push_back(GEP);
    P = GEP->getPointerOperand();
  }
  return dyn_cast<Argument>(P);
}

/// The objects that \p P leads to, each one element of an array.
Locations TextUsage::objectsAt(const Passed &P) const {
  if (P.Steps.empty())
    return Pointers.handed(P.Pointer, /*IsOne=*/true);
  Location Way;
  for (const GEPOperator *GEP : reverse(P.Steps))
    Types.follow(Way, *GEP);
  Types.enterElement(Way);
  Locations All;
  Type *Begin = elementOf(P.Steps.back()->getSourceElementType());
  for (Location &L : Pointers.resolve(P.Pointer, /*Scalar=*/false)) {
    Types.enterElement(L);
    int64_t Rest = 0;
    // A base class.
    if (!L.isElement() && elementOf(Types.declaredTypeAt(L)) != Begin &&
        !Types.descend(L, Rest, Begin))
      L = Location();
    Types.extend(L, Way.Path);
    addTo(All, std::move(L));
  }
  // Besides the known objects there can be others of the class.
  if (!isa<AllocaInst, GlobalVariable, GEPOperator>(P.Pointer) || All.empty())
    addTo(All, std::move(Way));
  return All;
}

/// Adds the copies of a text between \p To and \p From in \p F, for each call
/// by which \p F runs. False if there are too many.
bool TextUsage::addCopies(const Function &F, const Passed &To,
                          const Passed &From, unsigned Depth,
                          SmallVectorImpl<Copy> &Out) {
  Passed Inner[] = {To, From};
  const Argument *Args[2];
  for (unsigned N : {0, 1})
    Args[N] = argumentOf(Inner[N].Pointer, Inner[N].Steps);
  ArrayRef<CallBase *> Callers = Calls.callers(&F);
  bool IsKnown = all_of(Callers, [&](const CallBase *Call) {
    return Call->getCalledFunction() == &F;
  });
  if ((!Args[0] && !Args[1]) || Depth == MaxCallDepth || Callers.empty() ||
      !IsKnown || !Calls.allCallsKnown(F)) {
    Out.push_back({objectsAt(To), objectsAt(From)});
    return Out.size() <= MaxCalls;
  }
  for (const CallBase *Call : Callers) {
    Passed Outer[] = {To, From};
    for (unsigned N : {0, 1})
      if (Args[N])
        Outer[N] = {Call->getArgOperand(Args[N]->getArgNo()), Inner[N].Steps};
    if (!addCopies(*Call->getFunction(), Outer[0], Outer[1], Depth + 1, Out))
      return false;
  }
  return true;
}

TextUsage::TextUsage(Module &M, ModuleAnalysisManager &AM)
    : Calls(AM.getResult<SimpleCallGraph>(M)),
      Types(AM.getResult<LocationTypesAnalysis>(M)),
      Pointers(AM.getResult<PointsToAnalysis>(M)),
      Accesses(AM.getResult<ClassObjectAccess>(M)) {
  const VisibleWrites &Writes = AM.getResult<VisibleWritesAnalysis>(M);
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  // What is in a received message is no parameter of this program.
  auto IsOwn = [&](const Value *Pointer) {
    return Pointer && Pointer->getType()->isPointerTy() &&
           !Writes.isReceived(Pointer);
  };
  forEachCall(M, Rules, Rule::Text, [&](CallBase &Call, const Rule &Row) {
    if (Row.Relation == "copy") {
      if (Call.arg_size() < 2 || !IsOwn(Call.getArgOperand(0)) ||
          !IsOwn(Call.getArgOperand(1)))
        return;
      SmallVector<Copy, 4> Each;
      const Passed To{Call.getArgOperand(0)}, From{Call.getArgOperand(1)};
      if (!addCopies(*Call.getFunction(), To, From, 0, Each))
        Each.assign({{objectsAt(To), objectsAt(From)}});
      for (Copy &One : Each)
        Copies.push_back(std::move(One));
      return;
    }
    Use U{&Call, &Row, {}};
    for (unsigned N = 0; N < std::min(2U, Call.arg_size()); ++N)
      U.Operands.push_back(
          IsOwn(Call.getArgOperand(N))
              ? Pointers.handed(Call.getArgOperand(N), /*IsOne=*/true)
              : Locations());
    Uses.push_back(std::move(U));
  });
  forEachCall(M, Rules, Rule::Held, [&](CallBase &Call, const Rule &Row) {
    const Value *Holder =
        Row.Relation == "outof" ? holderOf(Call, Row) : nullptr;
    if (IsOwn(Holder))
      Numbers.push_back({&Call, Pointers.handed(Holder, /*IsOne=*/true)});
  });
  forEachCall(M, Rules, Rule::Property, [&](CallBase &Call, const Rule &Row) {
    Property P{&Call, &Row, {}};
    if (const Value *List = objectOf(Call, Row); IsOwn(List))
      Pointers.addElements(List, P.Elements);
    Properties.push_back(std::move(P));
  });
}

bool TextUsage::anyReaches(const Locations &From, const Locations &To) const {
  return any_of(From, [&](const Location &F) {
    return any_of(To,
                  [&](const Location &T) { return Accesses.reaches(F, T); });
  });
}

SmallVector<const TextUsage::Property *, 2>
TextUsage::propertiesOf(const Locations &Elements) const {
  SmallVector<const Property *, 2> Found;
  for (const Property &P : Properties)
    if (anyReaches(Elements, P.Elements))
      Found.push_back(&P);
  return Found;
}

SmallVector<CallBase *, 2> TextUsage::numbersFrom(const CallBase &Into,
                                                  const Rule &Row) const {
  SmallVector<CallBase *, 2> Found;
  const Value *Holder = holderOf(Into, Row);
  if (!Holder || !Holder->getType()->isPointerTy())
    return Found;
  Locations Objects = Pointers.handed(Holder, /*IsOne=*/true);
  for (const auto &[Call, From] : Numbers)
    if (anyReaches(Objects, From))
      Found.push_back(Call);
  return Found;
}

/// The operator of \p Compare, if it compares the result of string::compare()
/// with zero; otherwise empty.
static StringRef relationToZero(const CmpInst &Compare, const Value *Result) {
  const auto *Zero = dyn_cast<ConstantInt>(Compare.getOperand(1));
  if (Compare.getOperand(0) != Result || !Zero || !Zero->isZero() ||
      Compare.isUnsigned())
    return "";
  return relationOf(Compare.getPredicate());
}

/// `<` for `>`, if the threshold is on the left.
static StringRef swapped(StringRef Relation) {
  if (Relation == "<")
    return ">";
  if (Relation == "<=")
    return ">=";
  if (Relation == ">")
    return "<";
  return Relation == ">=" ? "<=" : Relation;
}

TextUsage::Found TextUsage::comparisonsOf(Locations Objects,
                                          bool IsList) const {
  Found Out;
  SmallPtrSet<const CallBase *, 8> Seen;
  for (unsigned Next = 0; Next < Objects.size() && Next < MaxObjects; ++Next) {
    const Location Here = Objects[Next];
    auto IsHere = [&](const Location &L) {
      return IsList ? Accesses.reaches(Here, L) : L.mayBe(Here);
    };
    for (const Copy &C : Copies)
      if (any_of(C.From, IsHere))
        for (const Location &To : C.To)
          if (none_of(Objects, [&](const Location &L) { return L.isSame(To); }))
            Objects.push_back(To);
    for (const Use &U : Uses) {
      StringRef Relation = U.Row->Relation;
      const auto *Operand = find_if(
          U.Operands, [&](const Locations &L) { return any_of(L, IsHere); });
      if (Operand == U.Operands.end() || !Seen.insert(U.Call).second)
        continue;
      unsigned N = Operand - U.Operands.begin();
      const Value *Text = U.Call->getArgOperand(N);
      bool Left = N == 0 && U.Call->arg_size() > 1;
      if (Relation != "compare") {
        Out.Comparisons.push_back(
            {U.Call, Left ? swapped(Relation) : Relation, Text});
        continue;
      }
      for (User *V : U.Call->users()) {
        auto *Compare = dyn_cast<CmpInst>(V);
        StringRef Own = Compare ? relationToZero(*Compare, U.Call) : "";
        if (Own.empty())
          ++Out.Lost;
        else
          Out.Comparisons.push_back({Compare, Left ? swapped(Own) : Own, Text});
      }
    }
  }
  return Out;
}

} // namespace tpc
