//===- Rules.cpp ----------------------------------------------------------===//
#include "Rules.h"

#include "BuiltinRules.h"
#include "Options.h"
#include "RuleFile.h"
#include "support/Names.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/MemoryBuffer.h"

using namespace llvm;

namespace tpc {

AnalysisKey RuleTableAnalysis::Key;
AnalysisKey RuleAnalysis::Key;

/// The number of IR operands before the first written argument.
static unsigned leading(const CallBase &Call, const Rule &R) {
  return (Call.hasStructRetAttr() ? 1 : 0) + (R.Method ? 1 : 0);
}

Value *argument(const CallBase &Call, const Rule &R,
                std::optional<unsigned> Number) {
  if (!Number)
    return nullptr;
  unsigned Index = leading(Call, R) + *Number;
  return Index < Call.arg_size() ? Call.getArgOperand(Index) : nullptr;
}

Value *objectOf(const CallBase &Call, const Rule &R) {
  if (!R.Method)
    return nullptr;
  unsigned Index = Call.hasStructRetAttr() ? 1 : 0;
  return Index < Call.arg_size() ? Call.getArgOperand(Index) : nullptr;
}

Value *holderOf(const CallBase &Call, const Rule &R) {
  if (R.Method)
    return objectOf(Call, R);
  if (R.Relation == "into")
    return Call.hasStructRetAttr() ? Call.getArgOperand(0) : nullptr;
  return argument(Call, R, 0);
}

static std::string slotKey(StringRef Class, unsigned Slot) {
  return (Class + " " + Twine(Slot)).str();
}

StringRef Rules::symbolAt(StringRef Class, unsigned Slot) const {
  auto It = Symbols.find(slotKey(Class, Slot));
  return It == Symbols.end() ? StringRef() : StringRef(It->second);
}

std::vector<std::string> Rules::nodeClasses() const {
  SetVector<StringRef> Found;
  for (const auto &Entry : ByName)
    for (const Rule &Row : Entry.second)
      if (Row.Resolve == "node")
        Found.insert(StringRef(Row.Function).rsplit("::").first);
  std::vector<std::string> Sorted(Found.begin(), Found.end());
  llvm::sort(Sorted);
  return Sorted;
}

Expected<Rules> Rules::load(const Options &Opts) {
  Rules R;
  auto Add = [&](StringRef Text, StringRef Origin) -> Error {
    Expected<RuleFile> File = parseRules(Text, Origin, Opts.Profile);
    if (!File)
      return File.takeError();
    for (Rule &Row : File->Rows) {
      if (Row.Slot && !Row.Symbol.empty())
        R.Symbols[slotKey(StringRef(Row.Function).rsplit("::").first,
                          *Row.Slot)] = Row.Symbol;
      R.ByName[Row.Function].push_back(std::move(Row));
    }
    append_range(R.OpaquePrefixes, File->Opaque);
    append_range(R.KeptPrefixes, File->Kept);
    append_range(R.CountingPrefixes, File->Counting);
    append_range(R.DestroyingPrefixes, File->Destroying);
    append_range(R.SilentPrefixes, File->Silent);
    append_range(R.KeptOverrides, File->KeptOverrides);
    append_range(R.Tools, File->Tools);
    R.ShowsOverrides |= File->ShowsOverrides;
    R.ContainerClasses.insert(File->ContainerClasses.begin(),
                              File->ContainerClasses.end());
    R.Transparent.insert(File->Transparent.begin(), File->Transparent.end());
    R.ReadingMethods.insert(File->ReadingMethods.begin(),
                            File->ReadingMethods.end());
    return Error::success();
  };
  for (StringRef Text : BuiltinRules)
    if (Error E = Add(Text, "built-in rules"))
      return std::move(E);
  for (const std::string &File : Opts.RuleFiles) {
    auto Buffer = MemoryBuffer::getFile(File);
    if (!Buffer)
      return createStringError(File + ": " + Buffer.getError().message());
    if (Error E = Add((*Buffer)->getBuffer(), File))
      return std::move(E);
  }
  return R;
}

static bool beginsWithOneOf(StringRef Name, ArrayRef<std::string> Prefixes) {
  return any_of(Prefixes, [&](const std::string &Prefix) {
    return Name.starts_with(Prefix);
  });
}

bool Rules::isOpaque(StringRef Name) const {
  return beginsWithOneOf(Name, OpaquePrefixes);
}

bool Rules::isCounting(StringRef Name) const {
  return beginsWithOneOf(Name, CountingPrefixes);
}

bool Rules::isDestroying(StringRef Name) const {
  return beginsWithOneOf(Name, DestroyingPrefixes);
}

bool Rules::isSilent(StringRef Name) const {
  return beginsWithOneOf(Name, SilentPrefixes);
}

bool Rules::keepsOverrides(StringRef Class) const {
  return beginsWithOneOf(className(Class), KeptOverrides);
}

bool Rules::isTool(StringRef Class) const {
  return beginsWithOneOf(Class, Tools);
}

RuleTables RuleTableAnalysis::run(Module &M, ModuleAnalysisManager &AM) {
  if (Known)
    return *Known;
  Expected<Rules> R = Rules::load(AM.getResult<OptionsAnalysis>(M));
  if (!R)
    return {std::make_shared<Rules>(), toString(R.takeError())};
  return {std::make_shared<Rules>(std::move(*R)), ""};
}

/// True if the parameter types written for \p F are those that \p R names.
static bool hasTypes(const Function &F, const Rule &R) {
  if (R.Types.empty())
    return true;
  SmallVector<std::string, 4> Types = parameterTypes(F);
  return Types.size() == R.Types.size() &&
         all_of(zip(Types, R.Types), [](auto P) {
           auto [Has, Wants] = P;
           return Wants == "*" || Has == Wants || plainType(Has) == Wants;
         });
}

/// True if \p F, a function, has a std::string operand. Many classes have
/// operators of the same name.
static bool takesText(const Function &F) {
  return any_of(parameterTypes(F), [](const std::string &T) {
    return StringRef(T).starts_with("std::__cxx11::basic_string<char,");
  });
}

const Rule *Rules::rowOf(const Function &F, StringRef Name) const {
  auto It = ByName.find(Name);
  if (It == ByName.end())
    return nullptr;
  for (const Rule &R : It->second) {
    unsigned Leading = (F.hasStructRetAttr() ? 1 : 0) + (R.Method ? 1 : 0);
    if ((!R.Arity || F.arg_size() == Leading + *R.Arity) && hasTypes(F, R) &&
        (R.Kind != Rule::Text || R.Method || takesText(F)))
      return &R;
  }
  return nullptr;
}

bool Rules::hasRow(StringRef Mangled) const {
  return ByName.contains(qualifiedName(Mangled));
}

const Rules::Match &Rules::match(const Function &F) const {
  auto [It, New] = Known.try_emplace(F.getName());
  if (!New)
    return It->second;
  Match &M = It->second;
  M.Name = qualifiedName(F.getName());
  M.Row = rowOf(F, M.Name);
  // Functions of one family, which only the mangled name distinguishes from
  // others.
  auto Begins = [&](StringRef Prefix) {
    return StringRef(M.Name).starts_with(Prefix) ||
           (Prefix.starts_with("_Z") && F.getName().starts_with(Prefix));
  };
  M.Opaque = any_of(OpaquePrefixes, Begins);
  M.Kept = any_of(KeptPrefixes, Begins);
  // A conversion has a type with scopes of its own, and puts nothing in.
  StringRef Name = M.Name;
  size_t Conversion = Name.find("::operator ");
  bool Converts = Conversion != StringRef::npos;
  auto [Class, Method] = Converts ? std::pair(Name.take_front(Conversion),
                                              Name.drop_front(Conversion + 2))
                                  : Name.rsplit("::");
  static constexpr StringRef Elements[] = {"operator[]", "at", "front", "back"};
  if (ContainerClasses.contains(Class))
    M.Container = ContainerMethod{
        !F.getName().starts_with("_ZNK") && !Converts &&
            !ReadingMethods.contains(Method) && !Method.starts_with("~"),
        is_contained(Elements, Method)};
  return M;
}

/// True for a static method. Without debug information, a method without
/// arguments counts as static.
static bool isStaticMethod(const Function &F) {
  const DISubprogram *SP = F.getSubprogram();
  if (!SP || !SP->getType())
    return F.arg_size() == (F.hasStructRetAttr() ? 1 : 0);
  DITypeRefArray Types = SP->getType()->getTypeArray();
  return Types.size() < 2 || !Types[1] || !Types[1]->isArtificial();
}

RuleMatches::RuleMatches(std::shared_ptr<const Rules> All, Module &M)
    : Tables(std::move(All)) {
  std::vector<std::string> Classes; // classes whose fields are parameters
  for (const Function &F : M) {
    const Rules::Match &Found = Tables->match(F);
    if (Found.Row && Found.Row->Kind == Rule::Subscription) {
      Subscribing[&F] = Found.Row;
    } else if (Found.Row) {
      Rows[&F] = Found.Row;
      if (Found.Row->Kind == Rule::Config)
        Classes.push_back(classArgument(F));
    } else if (Found.Opaque) {
      Opaque.insert(&F);
    } else if (Found.Container && !isStaticMethod(F)) {
      Containers.insert({&F, *Found.Container});
    }
    if (Found.Kept)
      Kept.insert(&F);
  }
  // The generator of such a class also generated these methods.
  if (Classes.empty())
    return;
  for (const Function &F : M)
    if (any_of(Classes, [&](StringRef Class) {
          StringRef Name = Tables->match(F).Name;
          return Name.consume_front(Class) && !Class.empty() &&
                 (Name.starts_with("::") || Name.starts_with("Statics::"));
        }))
      Opaque.insert(&F);
}

const Rule *RuleMatches::match(const CallBase &Call) const {
  const Function *Callee = Call.getCalledFunction();
  return Callee ? Rows.lookup(Callee) : nullptr;
}

const Rule *RuleMatches::subscription(const CallBase &Call) const {
  const Function *Callee = Call.getCalledFunction();
  return Callee ? Subscribing.lookup(Callee) : nullptr;
}

const RuleMatches::Inlined &RuleMatches::inlined(const DISubprogram &F) const {
  auto [It, New] = InlinedFunctions.try_emplace(&F);
  if (New) {
    StringRef Mangled = F.getLinkageName();
    if (const DISubprogram *Declared = F.getDeclaration();
        Mangled.empty() && Declared)
      Mangled = Declared->getLinkageName();
    std::string Name = qualifiedName(Mangled);
    It->second = {Tables->isTransparent(Name), Tables->isCounting(Name),
                  Tables->isDestroying(Name), Tables->isSilent(Name)};
  }
  return It->second;
}

const ContainerMethod *RuleMatches::container(const CallBase &Call) const {
  const Function *Callee = Call.getCalledFunction();
  const auto *It = Callee ? Containers.find(Callee) : Containers.end();
  return It == Containers.end() ? nullptr : &It->second;
}

namespace {

/// Finds library functions that call user code, such as the constructors of a
/// container's elements.
class UserCode {
public:
  explicit UserCode(const Options &Opts) : Sources(Opts) {}

  bool reachedFrom(const Function &F) {
    SmallSetVector<const Function *, 16> Work;
    Work.insert(&F);
    for (unsigned N = 0; N < Work.size(); ++N)
      for (const Instruction &I : instructions(*Work[N])) {
        const auto *Call = dyn_cast<CallBase>(&I);
        const Function *Callee = Call ? Call->getCalledFunction() : nullptr;
        if (!Callee || Callee->isDeclaration())
          continue;
        if (Sources.has(*Callee))
          return true;
        Work.insert(Callee);
      }
    return false;
  }

private:
  UserSources Sources;
};

} // namespace

void RuleMatches::closeContainers(const Options &Opts) {
  UserCode Users(Opts);
  for (const auto &[F, Method] : Containers)
    if (!Users.reachedFrom(*F))
      Opaque.insert(F);
}

RuleMatches RuleAnalysis::run(Module &M, ModuleAnalysisManager &AM) {
  RuleMatches Result(AM.getResult<RuleTableAnalysis>(M).Tables, M);
  Result.closeContainers(AM.getResult<OptionsAnalysis>(M));
  return Result;
}

} // namespace tpc
