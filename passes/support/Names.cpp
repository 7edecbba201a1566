//===- Names.cpp ----------------------------------------------------------===//
#include "support/Names.h"

#include "llvm/ADT/StringExtras.h"
#include "llvm/Demangle/Demangle.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/Support/SHA1.h"

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

/// The demangler fails at the name of a conversion to an instance of a
/// template. The most common one, std::string, has a short name too. Empty if
/// \p Mangled is no such name.
static std::string withShortString(StringRef Mangled) {
  static constexpr StringLiteral Long =
      "NSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE";
  size_t At = Mangled.find(Long);
  if (At == StringRef::npos || !Mangled.contains("cv"))
    return "";
  return (Mangled.take_front(At) + "Ss" + Mangled.drop_front(At + Long.size()))
      .str();
}

std::string qualifiedName(StringRef Mangled) {
  ItaniumPartialDemangler Demangler;
  // What is demangled refers to the text.
  std::string Name = Mangled.str(), Short;
  if (Demangler.partialDemangle(Name.c_str())) {
    Short = withShortString(Mangled);
    if (Short.empty() || Demangler.partialDemangle(Short.c_str()))
      return Name;
  }
  if (!Demangler.isFunction())
    return Name;
  std::string Scope =
      taken(Demangler.getFunctionDeclContextName(nullptr, nullptr));
  std::string Base = taken(Demangler.getFunctionBaseName(nullptr, nullptr));
  return withoutTemplateArguments(Scope.empty() ? Base : Scope + "::" + Base);
}

StringRef nameOfOriginal(const Function &F) {
  return F.getName().split(CopyMark).first;
}

StringRef linkageName(const Function &F) {
  const DISubprogram *SP = F.getSubprogram();
  StringRef Linkage = SP ? SP->getLinkageName() : "";
  return Linkage.empty() ? F.getName() : Linkage;
}

std::string className(StringRef Mangled) {
  std::string Text = demangle(("_ZTI" + Mangled).str());
  StringRef Name = Text;
  return Name.consume_front("typeinfo for ") ? Name.str() : Mangled.str();
}

StringRef unscoped(StringRef Name) {
  size_t Scope = Name.rfind("::");
  return Scope == StringRef::npos ? Name : Name.drop_front(Scope + 2);
}

std::string shortName(const Function &F) {
  return unscoped(qualifiedName(linkageName(F))).str() + "()";
}

std::string calleeName(const CallBase &Call) {
  const Function *F = Call.getCalledFunction();
  if (!F)
    return "a function that is not known";
  StringRef Name = F->getName();
  if (!Name.consume_front("llvm."))
    return shortName(*F);
  // The source calls `llvm.fabs.f64` fabs().
  return Name.split('.').first.str() + "()";
}

std::string functionName(const Function &F) { return demangle(linkageName(F)); }

std::string functionNameFor(const DILocation &Loc) {
  const DISubprogram *SP = Loc.getScope()->getSubprogram();
  StringRef Linkage = SP->getLinkageName();
  return qualifiedName(Linkage.empty() ? SP->getName() : Linkage);
}

SmallVector<std::string, 4> parameterTypes(const Function &F) {
  return parameterTypes(nameOfOriginal(F));
}

SmallVector<std::string, 4> parameterTypes(StringRef Mangled) {
  ItaniumPartialDemangler Demangler;
  std::string Name = Mangled.str();
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

std::string functionArgument(const Function &F) {
  ItaniumPartialDemangler Demangler;
  std::string Name = F.getName().str();
  if (Demangler.partialDemangle(Name.c_str()) || !Demangler.isFunction())
    return "";
  std::string Whole = taken(Demangler.getFunctionName(nullptr, nullptr));
  std::string Scope =
      taken(Demangler.getFunctionDeclContextName(nullptr, nullptr));
  return templateArgument(StringRef(Whole).drop_front(Scope.size()));
}

std::string resultType(const Function &F) {
  ItaniumPartialDemangler Demangler;
  std::string Name = F.getName().str();
  std::string Text;
  if (!Demangler.partialDemangle(Name.c_str()) && Demangler.isFunction()) {
    Text = taken(Demangler.getFunctionReturnType(nullptr, nullptr));
    // If the result type is deduced, the template argument tells it.
    if (std::string Plain = plainType(Text);
        Plain == "auto" || Plain == "decltype(auto)")
      Text = functionArgument(F);
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

/// True for a type that is one argument: one that is not a class.
static bool isOneArgument(StringRef Type) {
  static constexpr StringRef Scalars[] = {"bool",
                                          "char",
                                          "signed char",
                                          "unsigned char",
                                          "short",
                                          "int",
                                          "unsigned short",
                                          "unsigned int",
                                          "long",
                                          "float",
                                          "unsigned long",
                                          "long long",
                                          "unsigned long long",
                                          "double"};
  return Type.ends_with("&") || Type.ends_with("*") ||
         is_contained(Scalars, Type);
}

bool takesConst(StringRef Type) {
  if (!Type.consume_back(" const&") && !Type.consume_back(" const*"))
    return false;
  // A function object is not changed by being called; what it calls is seen
  // where that is done.
  bool LeadsElsewhere = Type.contains('*') || Type.contains("_ptr<");
  return !LeadsElsewhere;
}

SmallBitVector constArguments(const Function &F) {
  SmallBitVector Const(F.arg_size());
  unsigned First = F.hasStructRetAttr() ? 1 : 0;
  SmallVector<std::string, 4> Types = parameterTypes(F);
  // A method has its object before the others.
  if (First + Types.size() < F.arg_size())
    ++First;
  // An argument that is a class may be none, one or two in the code.
  if (First + Types.size() == F.arg_size() && all_of(Types, isOneArgument))
    for (const auto &[N, Type] : enumerate(Types))
      if (takesConst(Type))
        Const.set(First + N);
  return Const;
}

bool isDestructor(StringRef Mangled) {
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

/// `_ros_time_wait_` for `ROSTime::wait4`: the words of \p Name in lower case.
static std::string wordsOf(StringRef Name) {
  std::string Words = "_";
  for (size_t I = 0; I < Name.size(); ++I) {
    char C = Name[I];
    bool AfterUpper = I && isUpper(Name[I - 1]);
    bool BeforeLower = I + 1 < Name.size() && isLower(Name[I + 1]);
    if (isUpper(C) && (!AfterUpper || BeforeLower))
      Words += '_';
    Words += isAlpha(C) ? toLower(C) : '_';
  }
  return Words + '_';
}

bool waitsByName(const Function &F) {
  // With what C libraries put before a word: usleep, timedwait.
  static constexpr StringRef Words[] = {
      "sleep_", "wait_",  "_waitpid_", "_waitid_",
      "_spin_", "_join_", "_yield_",   "_call_available_"};
  std::string Found = wordsOf(unscoped(qualifiedName(F.getName())));
  return any_of(Words,
                [&](StringRef W) { return StringRef(Found).contains(W); });
}

const Argument *thisOf(const Function &F) {
  const DISubprogram *SP = F.getSubprogram();
  const unsigned N = F.hasStructRetAttr() ? 1 : 0;
  if (!SP || !SP->getType() || N >= F.arg_size())
    return nullptr;
  // Before the parameters stands the result.
  DITypeRefArray Types = SP->getType()->getTypeArray();
  const bool HasObject =
      Types.size() > 1 && Types[1] && Types[1]->isArtificial();
  return HasObject ? F.getArg(N) : nullptr;
}

std::string scopeOf(const Function &F) {
  return StringRef(qualifiedName(linkageName(F))).rsplit("::").first.str();
}

bool endsLife(const CallBase &Call) {
  const Function *F = Call.getCalledFunction();
  return F && F->isDeclarationForLinker() &&
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

bool isMessageClass(const DICompositeType &Class) {
  auto [Name, Arguments] = Class.getName().split('<');
  return Name.ends_with("_") && Arguments.starts_with("std::allocator<");
}

std::string uuidOf(StringRef Name) {
  static constexpr uint8_t Namespace[16] = {0x6b, 0x0f, 0x7a, 0x52, 0x2c, 0x9e,
                                            0x4d, 0x61, 0x9a, 0x37, 0x8f, 0x15,
                                            0xc3, 0x40, 0x5e, 0xd8};
  SHA1 Hash;
  Hash.update(ArrayRef(Namespace));
  Hash.update(Name);
  std::array<uint8_t, 20> Digest = Hash.final();
  Digest[6] = (Digest[6] & 0x0f) | 0x50;
  Digest[8] = (Digest[8] & 0x3f) | 0x80;
  std::string Hex = toHex(ArrayRef(Digest).take_front(16), /*LowerCase=*/true);
  return Hex.substr(0, 8) + "-" + Hex.substr(8, 4) + "-" + Hex.substr(12, 4) +
         "-" + Hex.substr(16, 4) + "-" + Hex.substr(20);
}

} // namespace tpc
