//===- Names.cpp ----------------------------------------------------------===//
#include "Names.h"

#include "llvm/ADT/StringExtras.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/Demangle/Demangle.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/IntrinsicInst.h"

#include <cstdlib>

using namespace llvm;

namespace tpc {

/// \p Text without what stands between angle brackets. `operator<` and its
/// kin are left whole: their bracket has no partner before the parameters.
static std::string withoutTemplateArguments(StringRef Text) {
  std::string Out;
  int Depth = 0;
  for (size_t I = 0; I < Text.size(); ++I) {
    char C = Text[I];
    bool Operator = StringRef(Out).ends_with("operator") ||
                    StringRef(Out).ends_with("operator<") ||
                    StringRef(Out).ends_with("operator-") ||
                    StringRef(Out).ends_with("operator>");
    if (C == '<' && !(Depth == 0 && Operator))
      ++Depth;
    else if (C == '>' && Depth > 0)
      --Depth;
    else if (Depth == 0)
      Out += C;
  }
  return Out;
}

std::string qualifiedName(StringRef Mangled) {
  ItaniumPartialDemangler Demangler;
  std::string Name = Mangled.str();
  if (Demangler.partialDemangle(Name.c_str()) || !Demangler.isFunction())
    return Name;
  auto Take = [](char *Text) {
    std::string S = Text ? Text : "";
    std::free(Text);
    return S;
  };
  std::string Scope =
      Take(Demangler.getFunctionDeclContextName(nullptr, nullptr));
  std::string Base = Take(Demangler.getFunctionBaseName(nullptr, nullptr));
  return withoutTemplateArguments(Scope.empty() ? Base : Scope + "::" + Base);
}

std::string functionName(const Function &F) {
  // The debug information keeps the name of what was cloned.
  const DISubprogram *SP = F.getSubprogram();
  StringRef Linkage = SP ? SP->getLinkageName() : "";
  return demangle(Linkage.empty() ? F.getName() : Linkage);
}

std::string functionNameFor(const DILocation &Loc) {
  const DISubprogram *SP = Loc.getScope()->getSubprogram();
  StringRef Linkage = SP->getLinkageName();
  return qualifiedName(Linkage.empty() ? SP->getName() : Linkage);
}

SmallVector<std::string, 4> parameterTypes(const Function &F) {
  ItaniumPartialDemangler Demangler;
  std::string Name = F.getName().str();
  if (Demangler.partialDemangle(Name.c_str()) || !Demangler.isFunction())
    return {};
  char *Text = Demangler.getFunctionParameters(nullptr, nullptr);
  std::string All = Text ? Text : "";
  std::free(Text);
  SmallVector<std::string, 4> Types(1);
  int Depth = 0;
  for (char C : StringRef(All)
                    .drop_front(All.empty() ? 0 : 1)
                    .drop_back(All.empty() ? 0 : 1)) {
    Depth += C == '<' || C == '(' ? 1 : C == '>' || C == ')' ? -1 : 0;
    if (C == ',' && Depth == 0)
      Types.emplace_back();
    else
      Types.back() += C;
  }
  for (std::string &T : Types)
    T = StringRef(T).trim().str();
  return Types;
}

/// True where \p Call surely does not change the object that it gets as
/// argument \p N: it is a constant reference, or `this` of a constant method.
static bool leavesAlone(const CallBase &Call, unsigned N) {
  const Function *Callee = Call.getCalledFunction();
  if (Call.onlyReadsMemory(N))
    return true;
  if (!Callee)
    return false;
  SmallVector<std::string, 4> Types = parameterTypes(*Callee);
  size_t Hidden =
      Callee->arg_size() - std::min(Callee->arg_size(), Types.size());
  if (N >= Hidden)
    return StringRef(Types[N - Hidden]).ends_with(" const&");
  return StringRef(demangle(Callee->getName())).ends_with(") const");
}

std::optional<std::string> constantText(const Value *Object) {
  if (!Object)
    return std::nullopt;
  StringRef Plain;
  if (getConstantStringInfo(Object, Plain))
    return Plain.str();
  if (!isa<AllocaInst>(Object))
    return std::nullopt;
  std::optional<std::string> Found;
  for (const Use &U : Object->uses()) {
    const auto *Call = dyn_cast<CallBase>(U.getUser());
    if (Call && isa<IntrinsicInst>(Call))
      continue;
    const Function *Callee = Call ? Call->getCalledFunction() : nullptr;
    if (!Callee || !Call->isArgOperand(&U))
      return std::nullopt;
    std::string Name = qualifiedName(Callee->getName());
    unsigned N = Call->getArgOperandNo(&U);
    if (N == 0 && Name.find("basic_string::~") != std::string::npos)
      continue;
    if (N == 0 && StringRef(Name).ends_with("basic_string::basic_string")) {
      StringRef Text;
      if (Found || Call->arg_size() < 2 ||
          !getConstantStringInfo(Call->getArgOperand(1), Text))
        return std::nullopt;
      Found = Text.str();
    } else if (!leavesAlone(*Call, N)) {
      return std::nullopt;
    }
  }
  return Found;
}

StringRef plainClassName(const StructType &T) {
  StringRef Name = T.hasName() ? T.getName() : "";
  if (!Name.consume_front("class."))
    Name.consume_front("struct.");
  auto [Head, Tail] = Name.rsplit('.');
  if (!Tail.empty() && all_of(Tail, [](char C) { return isDigit(C); }))
    Name = Head;
  Name.consume_back(".base");
  return Name;
}

} // namespace tpc
