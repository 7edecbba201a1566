//===- Names.cpp ----------------------------------------------------------===//
#include "support/Names.h"

#include "llvm/ADT/StringExtras.h"
#include "llvm/Demangle/Demangle.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/InstrTypes.h"

#include <cstdlib>

using namespace llvm;

namespace tpc {

/// \p Text without everything between angle brackets. `operator<` and the like
/// are kept: their bracket has no partner before the parameters.
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

/// Takes ownership of a string from the demangler.
static std::string taken(char *Text) {
  std::string S = Text ? Text : "";
  std::free(Text);
  return S;
}

std::string qualifiedName(StringRef Mangled) {
  ItaniumPartialDemangler Demangler;
  std::string Name = Mangled.str();
  if (Demangler.partialDemangle(Name.c_str()) || !Demangler.isFunction())
    return Name;
  std::string Scope =
      taken(Demangler.getFunctionDeclContextName(nullptr, nullptr));
  std::string Base = taken(Demangler.getFunctionBaseName(nullptr, nullptr));
  return withoutTemplateArguments(Scope.empty() ? Base : Scope + "::" + Base);
}

std::string functionName(const Function &F) {
  // The debug information keeps the name of the function that was cloned.
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
  std::string All = taken(Demangler.getFunctionParameters(nullptr, nullptr));
  if (All.empty() || All == "()")
    return {};
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

std::string plainType(StringRef Type) {
  Type = Type.trim();
  while (Type.consume_back("&") || Type.consume_back(" const") ||
         Type.consume_back(" "))
    ;
  std::string Plain = withoutTemplateArguments(Type);
  return Plain == "std::__cxx11::basic_string" ? "std::string" : Plain;
}

/// The text between the first angle brackets of \p Text, up to a comma.
static std::string templateArgument(StringRef Text) {
  size_t Begin = Text.find('<');
  if (Begin == StringRef::npos)
    return "";
  int Depth = 0;
  for (size_t I = Begin; I < Text.size(); ++I) {
    Depth += Text[I] == '<' ? 1 : Text[I] == '>' ? -1 : 0;
    if (Depth == 0 || (Depth == 1 && Text[I] == ','))
      return Text.slice(Begin + 1, I).trim().str();
  }
  return "";
}

std::string classArgument(const Function &F) {
  ItaniumPartialDemangler Demangler;
  std::string Name = F.getName().str();
  if (Demangler.partialDemangle(Name.c_str()) || !Demangler.isFunction())
    return "";
  return templateArgument(
      taken(Demangler.getFunctionDeclContextName(nullptr, nullptr)));
}

std::string resultType(const Function &F) {
  ItaniumPartialDemangler Demangler;
  std::string Name = F.getName().str();
  std::string Text;
  if (!Demangler.partialDemangle(Name.c_str()) && Demangler.isFunction()) {
    Text = taken(Demangler.getFunctionReturnType(nullptr, nullptr));
    // If the result type is deduced, the template argument tells it.
    if (StringRef(Text).contains("auto")) {
      std::string Whole = taken(Demangler.getFunctionName(nullptr, nullptr));
      std::string Scope =
          taken(Demangler.getFunctionDeclContextName(nullptr, nullptr));
      Text = templateArgument(StringRef(Whole).drop_front(Scope.size()));
    }
  }
  const Type *T = F.getReturnType();
  if (Text.empty())
    Text = T->isDoubleTy()      ? "double"
           : T->isFloatTy()     ? "float"
           : T->isIntegerTy(1)  ? "bool"
           : T->isIntegerTy(32) ? "int"
           : T->isIntegerTy()   ? "long"
                                : "";
  return Text;
}

static bool isDestructor(StringRef Mangled) {
  ItaniumPartialDemangler Demangler;
  return (Mangled.ends_with("D0Ev") || Mangled.ends_with("D1Ev") ||
          Mangled.ends_with("D2Ev")) &&
         !Demangler.partialDemangle(Mangled.str().c_str()) &&
         Demangler.isCtorOrDtor();
}

bool givesMemoryBack(StringRef Mangled) {
  return Mangled == "free" || Mangled.starts_with("_ZdlPv") ||
         Mangled.starts_with("_ZdaPv");
}

bool endsLife(const CallBase &Call) {
  const Function *F = Call.getCalledFunction();
  return F && F->isDeclaration() &&
         (givesMemoryBack(F->getName()) || isDestructor(F->getName()));
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
