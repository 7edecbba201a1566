//===- Rules.cpp ----------------------------------------------------------===//
#include "Rules.h"

#include "BuiltinRules.h"
#include "Names.h"
#include "Options.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/JSON.h"
#include "llvm/Support/MemoryBuffer.h"

using namespace llvm;

namespace tpc {

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

static std::optional<unsigned> number(const json::Object &Row, StringRef Key) {
  if (auto N = Row.getInteger(Key); N && *N >= 0)
    return static_cast<unsigned>(*N);
  return std::nullopt;
}

/// True where the row belongs to \p Profile; a row without profiles to all.
static bool belongs(const json::Object &Row, StringRef Profile) {
  const json::Array *Profiles = Row.getArray("profiles");
  if (!Profiles)
    return true;
  return any_of(*Profiles, [&](const json::Value &V) {
    return V.getAsString() == Profile;
  });
}

Error Rules::add(StringRef Text, StringRef Origin, StringRef Profile) {
  Expected<json::Value> Parsed = json::parse(Text);
  if (!Parsed)
    return createStringError(Origin + ": " + toString(Parsed.takeError()));
  const json::Object *Top = Parsed->getAsObject();
  if (!Top)
    return createStringError(Origin + ": rules are not a JSON object");
  const std::pair<StringRef, Rule::KindTy> Sections[] = {
      {"reads", Rule::Read},
      {"exposing", Rule::Exposing},
      {"topics", Rule::Topic},
      {"text", Rule::Text},
      {"held", Rule::Held}};
  for (auto [Section, Kind] : Sections) {
    const json::Array *Rows = Top->getArray(Section);
    if (!Rows)
      continue;
    for (const json::Value &V : *Rows) {
      const json::Object *Row = V.getAsObject();
      std::optional<StringRef> Function =
          Row ? Row->getString("function") : std::nullopt;
      if (!Function)
        return createStringError(Origin + ": a row of \"" + Section +
                                 "\" has no \"function\"");
      if (!belongs(*Row, Profile))
        continue;
      Rule R;
      R.Kind = Kind;
      R.Function = Function->str();
      R.Method = Row->getBoolean("method").value_or(false);
      R.Arity = number(*Row, "arity");
      R.Name = number(*Row, Kind == Rule::Exposing ? "topic" : "name");
      R.Value = number(*Row, "value");
      R.Default = number(*Row, "default");
      R.Relation = Row->getString("relation").value_or("").str();
      ByName[R.Function].push_back(std::move(R));
    }
  }
  if (const json::Array *Names = Top->getArray("transparent"))
    for (const json::Value &V : *Names)
      if (std::optional<StringRef> Name = V.getAsString())
        Transparent.insert(*Name);
  const std::pair<StringRef, std::vector<std::string> *> Prefixes[] = {
      {"opaque", &OpaquePrefixes}, {"kept", &KeptPrefixes}};
  for (auto [Section, List] : Prefixes)
    if (const json::Array *Names = Top->getArray(Section))
      for (const json::Value &V : *Names)
        if (std::optional<StringRef> Name = V.getAsString())
          List->push_back(Name->str());
  if (const json::Object *Containers = Top->getObject("containers")) {
    auto AddAll = [&](StringRef Key, StringSet<> &To) {
      if (const json::Array *Names = Containers->getArray(Key))
        for (const json::Value &V : *Names)
          if (std::optional<StringRef> Name = V.getAsString())
            To.insert(*Name);
    };
    AddAll("classes", ContainerClasses);
    AddAll("reading", ReadingMethods);
  }
  return Error::success();
}

static bool beginsWithAny(StringRef Name, ArrayRef<std::string> Prefixes) {
  return any_of(Prefixes, [&](const std::string &Prefix) {
    return Name.starts_with(Prefix);
  });
}

bool Rules::isOpaque(StringRef Name) const {
  return beginsWithAny(Name, OpaquePrefixes);
}

bool Rules::isOpaque(const Function &F) const {
  return isOpaque(StringRef(qualifiedName(F.getName())));
}

bool Rules::isKept(const Function &F) const {
  return beginsWithAny(qualifiedName(F.getName()), KeptPrefixes);
}

std::optional<ContainerMethod> Rules::container(const Function &F) const {
  std::string Name = qualifiedName(F.getName());
  auto [Class, Method] = StringRef(Name).rsplit("::");
  if (!ContainerClasses.contains(Class))
    return std::nullopt;
  bool IsConst = F.getName().starts_with("_ZNK");
  return ContainerMethod{!IsConst && !ReadingMethods.contains(Method) &&
                         !Method.starts_with("~")};
}

Expected<Rules> Rules::load(const Options &Opts) {
  Rules R;
  if (Error E = R.add(BuiltinRules, "built-in rules", Opts.Profile))
    return std::move(E);
  for (const std::string &File : Opts.RuleFiles) {
    auto Buffer = MemoryBuffer::getFile(File);
    if (!Buffer)
      return createStringError(File + ": " + Buffer.getError().message());
    if (Error E = R.add((*Buffer)->getBuffer(), File, Opts.Profile))
      return std::move(E);
  }
  return R;
}

/// True where one of \p F's operands is a std::string: its own methods, and
/// the operators, which many classes have under the same name.
static bool takesText(const Function &F) {
  return StringRef(qualifiedName(F.getName())).contains("basic_string::") ||
         any_of(parameterTypes(F), [](const std::string &T) {
           return StringRef(T).starts_with("std::__cxx11::basic_string<char,");
         });
}

const Rule *Rules::match(const Function &F) const {
  std::string Name = qualifiedName(F.getName());
  auto It = ByName.find(Name);
  if (It == ByName.end())
    return nullptr;
  for (const Rule &R : It->second) {
    unsigned Leading = (F.hasStructRetAttr() ? 1 : 0) + (R.Method ? 1 : 0);
    if ((!R.Arity || F.arg_size() == Leading + *R.Arity) &&
        (R.Kind != Rule::Text || takesText(F)))
      return &R;
  }
  return nullptr;
}

const Rule *RuleMatches::match(const CallBase &Call) const {
  const Function *Callee = Call.getCalledFunction();
  return Callee ? Rows.lookup(Callee) : nullptr;
}

const ContainerMethod *RuleMatches::container(const CallBase &Call) const {
  const Function *Callee = Call.getCalledFunction();
  auto It = Callee ? Containers.find(Callee) : Containers.end();
  return It == Containers.end() ? nullptr : &It->second;
}

namespace {

/// Which functions of libraries call the user's own: the constructors of the
/// elements of a container, say.
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

RuleMatches RuleAnalysis::run(Module &M, ModuleAnalysisManager &) {
  RuleMatches Result;
  const Options Opts = Options::fromCommandLine();
  Expected<Rules> Loaded = Rules::load(Opts);
  if (!Loaded) {
    Result.Error = toString(Loaded.takeError());
    return Result;
  }
  Result.Tables = std::make_shared<const Rules>(std::move(*Loaded));
  UserCode Users(Opts);
  for (const Function &F : M)
    if (const Rule *R = Result.Tables->match(F)) {
      Result.Rows[&F] = R;
    } else if (Result.Tables->isOpaque(F)) {
      Result.Opaque.insert(&F);
    } else if (auto Method = Result.Tables->container(F)) {
      Result.Containers[&F] = *Method;
      if (!Users.reachedFrom(F))
        Result.Opaque.insert(&F);
    }
  return Result;
}

} // namespace tpc
