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

TextUsage::TextUsage(Module &M, PointsTo &Pointers, AccessIndex &Accesses,
                     const VisibleWrites &Writes, const RuleMatches &Rules)
    : Pointers(Pointers), Accesses(Accesses) {
  // What is in a received message is no parameter of this program.
  auto IsOwn = [&](const Value *Pointer) {
    return Pointer && Pointer->getType()->isPointerTy() &&
           !Writes.isReceived(Pointer);
  };
  forEachCall(M, Rules, Rule::Text, [&](CallBase &Call, const Rule &Row) {
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
    for (const Use &U : Uses) {
      StringRef Relation = U.Row->Relation;
      if (Relation == "copy") {
        if (U.Operands.size() == 2 && any_of(U.Operands[1], IsHere))
          for (const Location &To : U.Operands[0])
            if (none_of(Objects,
                        [&](const Location &L) { return L.isSame(To); }))
              Objects.push_back(To);
        continue;
      }
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
