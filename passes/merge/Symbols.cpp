//===- Symbols.cpp --------------------------------------------------------===//
#include "merge/Symbols.h"

#include "plan/Checksum.h"
#include "support/Functions.h"

#include "llvm/ADT/STLExtras.h"
#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/Instructions.h"
#include "llvm/Support/StringSaver.h"

using namespace llvm;

namespace tpc {

/// True if other units may take \p V, or define it.
static bool isShared(const GlobalValue &V) {
  return !V.hasLocalLinkage() && !V.hasAppendingLinkage() &&
         !V.getName().starts_with("llvm.");
}

Symbols::Symbols(std::vector<Unit> All,
                 ArrayRef<std::vector<std::string>> Scopes)
    : Units(std::move(All)), IsGlobal(Units.size(), Scopes.empty()),
      SearchOrder(Units.size()) {
  setScopes(Scopes);
  findDefinitions();
  findSeparate();
}

void Symbols::setScopes(ArrayRef<std::vector<std::string>> Scopes) {
  StringMap<unsigned> ByName;
  for (auto [Number, Each] : enumerate(Units))
    ByName.try_emplace(Each.Name, Number);
  // A unit without bitcode is in none of them.
  auto Members = [&](const std::vector<std::string> &Scope) {
    Numbers Found;
    for (const std::string &Name : Scope)
      if (auto It = ByName.find(Name); It != ByName.end())
        Found.push_back(It->second);
    return Found;
  };
  for (auto [Number, Scope] : enumerate(Scopes)) {
    const Numbers Here = Members(Scope);
    for (unsigned Each : Here) {
      if (Number == 0)
        IsGlobal[Each] = true;
      else
        append_range(SearchOrder[Each], Here);
    }
  }
  for (unsigned Each = 0; Each < Units.size(); ++Each)
    if (SearchOrder[Each].empty())
      IsGlobal[Each] = true;
}

void Symbols::findDefinitions() {
  StringSaver Saver(Memory); // values are renamed
  for (auto [Number, Each] : enumerate(Units))
    for (const GlobalValue &V : Each.Code.global_values()) {
      if (!isShared(V) || V.isDeclarationForLinker())
        continue;
      auto It = Definitions.find(V.getName());
      if (It == Definitions.end())
        It = Definitions.insert({Saver.save(V.getName()), {}}).first;
      It->second.push_back(Number);
    }
}

/// The one of \p Definers that \p Unit finds: the first one, if it finds none.
unsigned Symbols::definerFor(unsigned Unit, const Numbers &Definers) const {
  for (unsigned Each : Definers)
    if (IsGlobal[Each])
      return Each;
  for (unsigned Each : SearchOrder[Unit])
    if (is_contained(Definers, Each))
      return Each;
  return definerFor(Definers.front(), Definers);
}

/// True if \p Name is a function of a header, or a variable of one, that all of
/// \p Definers compiled from the same text.
bool Symbols::isAlike(StringRef Name, const Numbers &Definers) const {
  // What a type is does not depend on who says it.
  if (Name.starts_with("_ZTI") || Name.starts_with("_ZTS"))
    return true;
  std::string Known;
  for (unsigned Each : Definers) {
    const GlobalValue *V = Units[Each].Code.getNamedValue(Name);
    if (!V->hasLinkOnceLinkage() && !V->hasWeakLinkage())
      return false;
    const auto *F = dyn_cast_or_null<Function>(V->getAliaseeObject());
    const std::string Sum = F ? checksumOf(*F) : "";
    if (Each != Definers.front() && Sum != Known)
      return false;
    Known = Sum;
  }
  return true;
}

/// Calls \p Fn for each function and variable whose code or value refers to
/// \p Of.
static void forEachUser(const GlobalValue &Of,
                        function_ref<void(const GlobalValue &)> Fn) {
  SmallPtrSet<const User *, 8> Known;
  SmallVector<const User *, 8> Work(Of.users());
  while (!Work.empty()) {
    const User *U = Work.pop_back_val();
    if (!Known.insert(U).second)
      continue;
    if (const auto *I = dyn_cast<Instruction>(U))
      Fn(*I->getFunction());
    else if (const auto *V = dyn_cast<GlobalValue>(U))
      Fn(*V);
    else
      append_range(Work, U->users());
  }
}

/// What is the same text is not the same code if it refers to \p Name.
void Symbols::separateUsers(StringRef Name, std::vector<StringRef> &Work) {
  for (const Unit &Each : Units) {
    const GlobalValue *Of = Each.Code.getNamedValue(Name);
    if (!Of)
      continue;
    SmallPtrSet<const GlobalValue *, 8> Known;
    SmallVector<const GlobalValue *, 8> Through{Of};
    while (!Through.empty())
      forEachUser(*Through.pop_back_val(), [&](const GlobalValue &User) {
        if (!Known.insert(&User).second)
          return;
        if (User.hasLocalLinkage())
          Through.push_back(&User);
        else if (auto It = Apart.find(User.getName());
                 It != Apart.end() && !User.getName().starts_with("_ZTI") &&
                 Separate.insert(User.getName()).second)
          Work.push_back(It->first());
      });
  }
}

void Symbols::findSeparate() {
  std::vector<StringRef> Work;
  for (auto &[Name, Definers] : Definitions) {
    if (Definers.size() < 2)
      continue;
    // Nobody takes what the unit itself does not.
    erase_if(Definers, [All = Definers, this](unsigned Each) {
      return definerFor(Each, All) != Each;
    });
    if (Definers.size() < 2)
      continue;
    Apart.insert(Name);
    if (!isAlike(Name, Definers)) {
      Separate.insert(Name);
      Work.push_back(Name);
    }
  }
  while (!Work.empty()) {
    StringRef Name = Work.back();
    Work.pop_back();
    separateUsers(Name, Work);
  }
}

/// The name of the definition of \p Name in \p Unit that has to be told from
/// another one. Numbers behind the names of local values are left out of
/// checksums.
std::string Symbols::newName(StringRef Name, unsigned Unit) {
  std::string &New = NewNames[(Name + "\n" + Twine(Unit)).str()];
  for (unsigned Number = Unit; New.empty(); Number += Units.size()) {
    std::string Text = (Name + "." + Twine(Number)).str();
    if (none_of(Units, [&](const Symbols::Unit &Each) {
          return Each.Code.getNamedValue(Text);
        }))
      New = std::move(Text);
  }
  Renamed[New] = Name.str();
  return New;
}

/// Makes \p V, a definition, the declaration of what another unit defines.
static GlobalValue &makeDeclaration(GlobalValue &V) {
  if (auto *F = dyn_cast<Function>(&V)) {
    F->deleteBody();
    F->setComdat(nullptr);
    return V;
  }
  if (auto *Variable = dyn_cast<GlobalVariable>(&V)) {
    Variable->setInitializer(nullptr);
    Variable->setLinkage(GlobalValue::ExternalLinkage);
    Variable->setComdat(nullptr);
    return V;
  }
  Module &M = *V.getParent();
  GlobalValue *Declared;
  if (auto *T = dyn_cast<FunctionType>(V.getValueType()))
    Declared = Function::Create(T, GlobalValue::ExternalLinkage,
                                V.getAddressSpace(), "", &M);
  else
    Declared = new GlobalVariable(M, V.getValueType(), /*isConstant=*/false,
                                  GlobalValue::ExternalLinkage, nullptr);
  Declared->takeName(&V);
  V.replaceAllUsesWith(Declared);
  V.eraseFromParent();
  return *Declared;
}

void Symbols::choose(unsigned Unit) {
  Module &Code = Units[Unit].Code;
  SmallVector<GlobalValue *, 0> Taken, TakenAliases, Named;
  SmallPtrSet<const Comdat *, 8> Split;
  for (GlobalValue &V : Code.global_values()) {
    auto It = isShared(V) ? Definitions.find(V.getName()) : Definitions.end();
    if (It == Definitions.end())
      continue;
    const bool IsSeparate = Separate.contains(V.getName());
    // What is alike is that of the first unit, for all.
    const unsigned From =
        definerFor(IsSeparate ? Unit : It->second.front(), It->second);
    if (From != Unit && !V.isDeclarationForLinker())
      (isa<GlobalObject>(V) ? Taken : TakenAliases).push_back(&V);
    else if (IsSeparate)
      Named.push_back(&V);
    if (auto *Object = dyn_cast<GlobalObject>(&V); Object && IsSeparate)
      Split.insert(Object->getComdat());
  }
  // The linker would choose one for all units.
  for (GlobalObject &Object : Code.global_objects())
    if (Object.hasComdat() && Split.contains(Object.getComdat()))
      Object.setComdat(nullptr);
  // Aliases first: what they lead to may become a declaration.
  for (GlobalValue *V : concat<GlobalValue *>(TakenAliases, Taken)) {
    GlobalValue &Declared = makeDeclaration(*V);
    if (Separate.contains(Declared.getName()))
      Named.push_back(&Declared);
  }
  for (GlobalValue *V : Named) {
    StringRef Name = V->getName();
    const Numbers &Definers = Definitions.find(Name)->second;
    const unsigned From = definerFor(Unit, Definers);
    if (auto *F = dyn_cast<Function>(V); F && From == Unit)
      F->addFnAttr(LocalOf, (Units[Unit].Name + ":" + Name).str());
    if (From != Definers.front())
      V->setName(newName(Name, From));
  }
}

void Symbols::choose() {
  for (unsigned Unit = 0; Unit < Units.size(); ++Unit)
    choose(Unit);
}

} // namespace tpc
