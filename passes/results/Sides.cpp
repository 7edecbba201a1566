//===- Sides.cpp ----------------------------------------------------------===//
#include "results/Sides.h"

#include "params/Texts.h"

using namespace llvm;

namespace tpc {

Sides::Sides(const ParameterUsage &Usage, const ParamCallFinder::Result &Reads,
             const CallGraphResult &Calls, PointsTo &Pointers,
             VisibleWrites &Writes,
             function_ref<bool(const ParameterComparison &)> IsExposed)
    : Usage(Usage), Reads(Reads), Values(Reads, Calls, Pointers, Writes) {
  for (const ParameterComparison &C : Usage.Comparisons)
    if (C.Compare && IsExposed(C))
      ByCompare[C.Compare].push_back(&C);
}

/// The length of the path from the read to the predicate.
size_t Sides::lengthOf(const ParameterComparison &C) const {
  return C.Decisions.empty() ? 0 : Usage.pathTo(C.Decisions.front().Way).size();
}

/// Nobody knows whether two parameters whose names depend on the call are the
/// same.
bool Sides::isSameParameter(unsigned Read, unsigned Other) const {
  StringRef Name = Reads[Read].Name;
  return Read == Other ||
         (Name == Reads[Other].Name && !Name.contains(DynamicName));
}

static bool decides(const ParameterComparison &C, const Instruction &P) {
  return C.Compare == &P || any_of(C.Decisions, [&](const Decision &D) {
           return D.Predicate == &P;
         });
}

bool Sides::isOtherWay(const ParameterComparison &C,
                       const Instruction &Predicate) {
  return C.Compare && any_of(ByCompare.lookup(C.Compare),
                             [&](const ParameterComparison *Other) {
                               return Other->Operand != C.Operand &&
                                      decides(*Other, Predicate) &&
                                      isSameParameter(Other->Read, C.Read) &&
                                      lengthOf(*Other) < lengthOf(C) &&
                                      !isMeasured(*Other, Predicate);
                             });
}

bool Sides::isMeasured(const ParameterComparison &C,
                       const Instruction &Predicate) {
  if (!C.Compare)
    return false;
  const auto Others = ByCompare.lookup(C.Compare);
  // A formula with other values is no threshold where the other side is one.
  if (C.How.Variables && any_of(Others, [&](const ParameterComparison *Other) {
        return Other->Operand != C.Operand && !Other->How.Variables;
      }))
    return true;
  const Value *Own = C.Compare->getOperand(C.Operand);
  const Value *Other = C.Compare->getOperand(1 - C.Operand);
  // As where it is compared with a constant itself.
  if (C.How.Variables && Values.isWrittenDown(Other))
    return true;
  const bool AreBoth = any_of(Others, [&](const ParameterComparison *O) {
    return O->Operand != C.Operand && decides(*O, Predicate);
  });
  // A value that was computed from the parameter alone is not measured,
  // whatever library computed it. Of a list, only the library knows. Most
  // counters are configured too: they count up from a constant.
  const bool IsPlain = C.How.kind() == Transform::None && C.How.Part.empty() &&
                       !isa<CallBase>(stripCasts(Own));
  if (!AreBoth && !(isa<Constant>(Other) && IsPlain))
    return false;
  // Elements are data where the other side is a parameter as a whole.
  const bool IsData =
      !C.How.Part.empty() && any_of(Others, [&](const ParameterComparison *O) {
        return O->Operand != C.Operand && O->How.Part.empty();
      });
  return !Values.has(Own) && (IsData || Values.has(Other, /*Surely=*/true));
}

} // namespace tpc
