//===- Overriding.cpp -----------------------------------------------------===//
#include "slice/Overriding.h"

#include "calls/ClassHierarchy.h"
#include "support/Names.h"

#include "llvm/BinaryFormat/Dwarf.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/Support/FileSystem.h"

using namespace llvm;

namespace tpc {

namespace {

/// Finds the package of a source file: the nearest folder with a package.xml.
class Packages {
public:
  /// Empty if \p Path is in no package.
  std::string of(StringRef Path) {
    StringRef Folder = sys::path::parent_path(Path);
    if (Folder.empty() || Folder == Path)
      return "";
    if (auto It = Known.find(Folder); It != Known.end())
      return It->second;
    SmallString<256> Manifest(Folder);
    sys::path::append(Manifest, "package.xml");
    std::string Found = sys::fs::exists(Manifest) ? Folder.str() : of(Folder);
    return Known[Folder] = Found;
  }

private:
  StringMap<std::string> Known;
};

class OverrideFinder {
public:
  OverrideFinder(const Module &M, const CallGraphResult &Calls,
                 const RuleMatches &Rules, const Options &Opts)
      : M(M), Calls(Calls), Rules(Rules), Opts(Opts), Sources(Opts) {}

  /// Adds the function that \p V shows to \p Out if it overrides one of another
  /// library.
  void find(const VirtualFunction &V, OverridingFunctions &Out);

private:
  bool isOthers(const Function &F) const;
  bool overrides(const Function &F, unsigned Slot, StringRef Base,
                 bool IsCalled);
  bool isElsewhere(const DICompositeType &Base, const Function &F);
  bool isCalledThroughClass(const Function &F) const;

  const Module &M;
  const CallGraphResult &Calls;
  const RuleMatches &Rules;
  const Options &Opts;
  UserSources Sources;
  Packages Folders;
};

} // namespace

/// The function that the thunk \p F adjusts `this` for; \p F if it is none.
static Function *behindThunk(Function *F) {
  if (!F->getSubprogram() || !F->getSubprogram()->isThunk())
    return F;
  for (Instruction &I : instructions(F))
    if (auto *Call = dyn_cast<CallBase>(&I); Call && !isa<IntrinsicInst>(I))
      return Call->getCalledFunction();
  return nullptr;
}

static const DICompositeType *baseClass(const DINode *Element) {
  const auto *Derived = dyn_cast_or_null<DIDerivedType>(Element);
  return Derived && Derived->getTag() == dwarf::DW_TAG_inheritance
             ? dyn_cast_or_null<DICompositeType>(
                   DebugTypes::plain(Derived->getBaseType()))
             : nullptr;
}

/// The base of \p Class with the mangled name \p Name; null if the debug
/// information has none.
static const DICompositeType *findBase(const DICompositeType &Class,
                                       StringRef Name) {
  for (const DINode *N : Class.getElements())
    if (const DICompositeType *Base = baseClass(N)) {
      if (DebugTypes::identifierOf(*Base) == ("_ZTS" + Name).str())
        return Base;
      if (const DICompositeType *Further = findBase(*Base, Name))
        return Further;
    }
  return nullptr;
}

/// True if \p Class itself declares a virtual function in \p Slot; none if its
/// members are not known.
static std::optional<bool> declares(const DICompositeType *Class,
                                    unsigned Slot) {
  if (!Class || Class->isForwardDecl())
    return std::nullopt;
  return virtualIn(*Class, Slot) != nullptr;
}

bool OverrideFinder::isCalledThroughClass(const Function &F) const {
  return any_of(Calls.callers(&F), [](const CallBase *Call) {
    return ClassHierarchy::match(*Call).has_value();
  });
}

/// True if \p F is an inline function of a class of another library.
bool OverrideFinder::isOthers(const Function &F) const {
  const auto *Class =
      dyn_cast_or_null<DICompositeType>(F.getSubprogram()->getScope());
  std::string Name = Class ? DebugTypes::identifierOf(*Class) : "";
  if (!StringRef(Name).starts_with("_ZTS"))
    return false;
  Name[3] = 'I';
  const GlobalVariable *Info = M.getNamedGlobal(Name);
  return Info && Info->isDeclaration();
}

/// True if the header of \p Base belongs to somebody else than \p F.
bool OverrideFinder::isElsewhere(const DICompositeType &Base,
                                 const Function &F) {
  std::string Header = pathOf(Base.getFile());
  return !Opts.isUserSource(Header) ||
         Folders.of(Header) != Folders.of(pathOf(F.getSubprogram()->getFile()));
}

/// True if \p F, in \p Slot of a vtable, overrides a function of \p Base, a
/// class of another library. \p IsCalled says whether a call through a class
/// enters it in this unit.
bool OverrideFinder::overrides(const Function &F, unsigned Slot, StringRef Base,
                               bool IsCalled) {
  if (Rules.keepsOverrides(Base))
    return false;
  const auto *Class =
      dyn_cast_or_null<DICompositeType>(F.getSubprogram()->getScope());
  const DICompositeType *Known = Class ? findBase(*Class, Base) : nullptr;
  const std::optional<bool> Declared = declares(Known, Slot);
  if (Declared && !*Declared)
    return false;
  const GlobalVariable *Info = M.getNamedGlobal(("_ZTI" + Base).str());
  if (Info && Info->isDeclaration())
    // Without the members of the class, what this unit calls through a class of
    // its own may be new in that.
    return Declared || !IsCalled;
  if (Known && isElsewhere(*Known, F))
    return true;
  return Opts.SharedLibrary && Declared && !IsCalled;
}

void OverrideFinder::find(const VirtualFunction &V, OverridingFunctions &Out) {
  Function *F = behindThunk(V.F);
  if (!F || F->isDeclaration() || !Sources.has(*F) || Rules.isOpaque(*F) ||
      F->getSubprogram()->getName().starts_with("~") || isOthers(*F))
    return;
  // Calls through the second base of a class enter the thunk.
  const bool IsCalled = isCalledThroughClass(*F) || isCalledThroughClass(*V.F);
  for (StringRef Base : V.Bases)
    if (overrides(*F, V.Slot, Base, IsCalled)) {
      Out.Functions.insert(F);
      Out.Bases.insert(className(Base));
    }
}

OverridingFunctions overridingFunctions(Module &M, const CallGraphResult &Calls,
                                        const RuleMatches &Rules,
                                        const Options &Opts) {
  OverridingFunctions Found;
  if (!Rules.showsOverrides())
    return Found;
  OverrideFinder In(M, Calls, Rules, Opts);
  ClassHierarchy(M).forEachFunction(
      [&](const VirtualFunction &V) { In.find(V, Found); });
  return Found;
}

SmallVector<const Argument *, 4> writtenArguments(const Function &F) {
  SmallVector<const Argument *, 4> Written;
  SmallVector<std::string, 4> Types = parameterTypes(F);
  // If a parameter is not one argument in the code, no type is known.
  size_t First = (F.hasStructRetAttr() ? 1 : 0) + 1; // the result, `this`
  if (First + Types.size() != F.arg_size())
    First = F.arg_size();
  for (const Argument &Arg : F.args()) {
    const unsigned N = Arg.getArgNo();
    StringRef Type = N < First ? "" : StringRef(Types[N - First]);
    bool IsHanded = Type.ends_with("&") || Type.ends_with("*");
    if (Arg.getType()->isPointerTy() &&
        (Arg.hasStructRetAttr() || (IsHanded && !takesConst(Type))))
      Written.push_back(&Arg);
  }
  return Written;
}

namespace {

/// The classes that this unit defines: by their type information, or by a
/// method that is not in a header. Without a virtual function that is not
/// inline, the type information is in every unit; then a class of which this
/// unit overrides functions of another library is no own one.
class OwnClasses {
public:
  OwnClasses(Module &M, const StringSet<> &Bases) {
    for (const GlobalVariable &G : M.globals())
      if (StringRef Name = G.getName();
          !G.isDeclaration() && Name.consume_front("_ZTI"))
        if (std::string Class = className(Name);
            !G.isWeakForLinker() || !Bases.contains(Class))
          Names.insert(Class);
    for (const Function &F : definedFunctions(M))
      if (const DISubprogram *SP = F.getSubprogram();
          SP && SP->getUnit() &&
          pathOf(SP->getFile()) == pathOf(SP->getUnit()->getFile()))
        Names.insert(scopeOf(F));
  }

  bool has(StringRef Class) const { return Names.contains(Class); }

private:
  StringSet<> Names;
};

} // namespace

/// The class of another library in whose part of the object \p This
/// \p Pointer lies, or in an array that this part points to; empty if it lies
/// elsewhere.
static std::string inheritedPart(const Value *Pointer, const Argument *This,
                                 const OwnClasses &Own) {
  // The outermost field is the one nearest to `this`.
  StructType *Outermost = nullptr;
  constexpr unsigned MostSteps = 16;
  for (unsigned N = 0; N < MostSteps && Pointer != This; ++N) {
    if (const auto *GEP = dyn_cast<GEPOperator>(Pointer)) {
      if (auto *Class = dyn_cast<StructType>(GEP->getSourceElementType()))
        Outermost = Class;
      Pointer = GEP->getPointerOperand();
    } else if (const auto *Load = dyn_cast<LoadInst>(Pointer);
               Load && !Outermost) {
      Pointer = Load->getPointerOperand();
    } else {
      return "";
    }
  }
  if (Pointer != This || !Outermost)
    return "";
  StringRef Class = plainClassName(*Outermost);
  return Own.has(Class) ? "" : Class.str();
}

/// The same for the object on which \p Call calls a method of another library
/// that is not const.
static std::string inheritedObject(const CallBase &Call, const Argument *This,
                                   const OwnClasses &Own) {
  const Function *Callee = Call.getCalledFunction();
  if (!Callee || !Callee->isDeclarationForLinker() || endsLife(Call) ||
      !Callee->getName().starts_with("_ZN") ||
      Callee->getName().starts_with("_ZNK"))
    return "";
  const unsigned First = Callee->hasStructRetAttr() ? 1 : 0;
  // A method has its object before what it is written with.
  if (Call.arg_size() <= First + parameterTypes(*Callee).size())
    return "";
  const Value *Object = Call.getArgOperand(First);
  // A base that is not at the beginning is some bytes further on.
  while (const auto *GEP = dyn_cast<GEPOperator>(Object)) {
    if (!GEP->getSourceElementType()->isIntegerTy(8))
      return "";
    Object = GEP->getPointerOperand();
  }
  std::string Class = scopeOf(*Callee);
  if (Object != This || Own.has(Class))
    return "";
  return Class;
}

SmallVector<InheritedWrite, 0>
inheritedWrites(Module &M, const OverridingFunctions &Overriding) {
  SmallVector<InheritedWrite, 0> Found;
  StringSet<> Derived;
  for (const Function *F : Overriding.Functions)
    Derived.insert(scopeOf(*F));
  if (Derived.empty())
    return Found;
  const OwnClasses Own(M, Overriding.Bases);
  for (Function &F : definedFunctions(M)) {
    const std::string Class = scopeOf(F);
    StringRef Method = F.getSubprogram() ? F.getSubprogram()->getName() : "";
    // What a constructor sets is not seen before it ends.
    const Argument *This = thisOf(F);
    if (!This || !Derived.contains(Class) || Method.empty() ||
        Method.starts_with("~") || Method == unscoped(Class))
      continue;
    for (Instruction &I : instructions(F)) {
      std::string Part;
      if (const auto *Store = dyn_cast<StoreInst>(&I))
        Part = inheritedPart(Store->getPointerOperand(), This, Own);
      else if (const auto *Call = dyn_cast<CallBase>(&I))
        Part = inheritedObject(*Call, This, Own);
      if (!Part.empty())
        Found.push_back({&I, unscoped(Part).str()});
    }
  }
  return Found;
}

} // namespace tpc
