//===- Names.cpp ----------------------------------------------------------===//
#include "Names.h"

#include "llvm/ADT/StringExtras.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/Demangle/Demangle.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Instructions.h"

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

/// The constant that \p Call, a constructor of a string, gives its object.
static std::optional<std::string> constructedText(const CallBase &Call,
                                                  const Value *Object) {
  const Function *Callee = Call.getCalledFunction();
  if (!Callee || Call.arg_size() < 2 || Call.getArgOperand(0) != Object)
    return std::nullopt;
  StringRef Text;
  if (getConstantStringInfo(Call.getArgOperand(1), Text))
    return Text.str();
  return std::nullopt;
}

/// True where \p Name is a constructor of std::string.
static bool isStringConstructor(StringRef Name) {
  return Name.ends_with("basic_string::basic_string");
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
  for (const User *U : Object->users()) {
    const auto *Call = dyn_cast<CallBase>(U);
    if (!Call || !Call->getCalledFunction() ||
        !isStringConstructor(
            qualifiedName(Call->getCalledFunction()->getName())) ||
        Call->getArgOperand(0) != Object)
      continue;
    std::optional<std::string> Text = constructedText(*Call, Object);
    if (!Text || (Found && *Found != *Text))
      return std::nullopt;
    Found = Text;
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
