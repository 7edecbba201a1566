//===- RuleFile.cpp -------------------------------------------------------===//
#include "RuleFile.h"

#include "llvm/ADT/StringExtras.h"
#include "llvm/Support/JSON.h"

#include <limits>

using namespace llvm;

namespace tpc {

namespace {

/// A section of a file: the kind of its rows, and the keys that a row may have
/// besides `function`, `method`, `arity`, `types` and `profiles`.
struct Section {
  StringLiteral Name;
  Rule::KindTy Kind;
  ArrayRef<StringLiteral> Keys;
  ArrayRef<StringLiteral> Required;
};

/// A list of names at the top of a file.
struct NameList {
  StringLiteral Key;
  std::vector<std::string> RuleFile::*Names;
};

class Reader {
public:
  Reader(StringRef Origin, StringRef Profile)
      : Origin(Origin), Profile(Profile) {}

  Error file(const json::Value &Top, RuleFile &Out);

private:
  Error wrong(const Twine &Place, const Twine &Why) const {
    return createStringError(Origin + ": " + Place + ": " + Why);
  }
  Error row(const json::Value &V, const Section &In, StringRef Place,
            RuleFile &Out);
  Error containers(const json::Value &V, StringRef Place, RuleFile &Out);
  Error overriding(const json::Value &V, StringRef Place, RuleFile &Out);
  bool belongs(ArrayRef<std::string> Profiles) const {
    // What has no profiles belongs to every profile.
    return Profiles.empty() || is_contained(Profiles, Profile);
  }
  Error field(StringRef Key, const json::Value &V, StringRef Place, Rule &R);
  Error part(const json::Value &V, StringRef Place, Rule &R);
  Error number(const json::Value &V, StringRef Place,
               std::optional<unsigned> &Out);
  Error text(const json::Value &V, StringRef Place, std::string &Out);
  Error texts(const json::Value &V, StringRef Place,
              std::vector<std::string> &Out);
  Error truth(const json::Value &V, StringRef Place, bool &Out);
  Error factor(const json::Value &V, StringRef Place, double &Out);
  Error meaning(const Rule &R, StringRef Place);
  Error numbers(const json::Value &V, StringRef Place,
                std::vector<unsigned> &Out);

  StringRef Origin, Profile;
};

} // namespace

static constexpr StringLiteral ReadKeys[] = {
    "name", "value", "default", "handle", "resolve", "many", "node"};
static constexpr StringLiteral ConfigKeys[] = {"handle", "resolve"};
static constexpr StringLiteral ReadRequired[] = {"name", "value"};
static constexpr StringLiteral ExposingKeys[] = {"topic"};
static constexpr StringLiteral TopicKeys[] = {"name", "handle"};
static constexpr StringLiteral TopicRequired[] = {"name"};
static constexpr StringLiteral SubscriptionKeys[] = {"name", "callbacks",
                                                     "handle"};
static constexpr StringLiteral NameKeys[] = {"parts", "to", "absolute"};
static constexpr StringLiteral NameRequired[] = {"parts", "to"};
static constexpr StringLiteral TextKeys[] = {"relation"};
static constexpr StringLiteral HeldKeys[] = {"relation", "value", "per_second",
                                             "nanoseconds", "rest"};
static constexpr StringLiteral AccessorKeys[] = {"type"};
static constexpr StringLiteral CallbackKeys[] = {"answer", "callbacks", "name",
                                                 "node"};
static constexpr StringLiteral CallbackRequired[] = {"callbacks"};

static const Section Sections[] = {
    {"reads", Rule::Read, ReadKeys, ReadRequired},
    {"exposing", Rule::Exposing, ExposingKeys, {}},
    {"topics", Rule::Topic, TopicKeys, TopicRequired},
    {"subscriptions", Rule::Subscription, SubscriptionKeys, {}},
    {"handles", Rule::Naming, NameKeys, NameRequired},
    {"names", Rule::Naming, NameKeys, NameRequired},
    {"accessors", Rule::Accessor, AccessorKeys, {}},
    {"identities", Rule::Identity, {}, {}},
    {"callbacks", Rule::Callback, CallbackKeys, CallbackRequired},
    {"configs", Rule::Config, ConfigKeys, {}},
    {"text", Rule::Text, TextKeys, TextKeys},
    {"held", Rule::Held, HeldKeys, TextKeys},
    {"properties", Rule::Property, TextKeys, TextKeys},
};

static constexpr NameList NameLists[] = {
    {"opaque", &RuleFile::Opaque},
    {"kept", &RuleFile::Kept},
    {"counting", &RuleFile::Counting},
    {"silent", &RuleFile::Silent},
    {"transparent", &RuleFile::Transparent},
    {"destroying", &RuleFile::Destroying},
};

/// Sorted, so that the first error reported for a file is always the same.
static std::vector<StringRef> keysOf(const json::Object &O) {
  std::vector<StringRef> Keys;
  for (const auto &[Key, Unused] : O)
    Keys.push_back(Key);
  sort(Keys);
  return Keys;
}

/// The largest argument number; no function has more arguments.
static constexpr int64_t MaxNumber = 255;

Error Reader::number(const json::Value &V, StringRef Place,
                     std::optional<unsigned> &Out) {
  std::optional<int64_t> N = V.getAsInteger();
  if (!N || *N < 0 || *N > MaxNumber)
    return wrong(Place, "must be a whole number from 0 to 255");
  Out = static_cast<unsigned>(*N);
  return Error::success();
}

Error Reader::text(const json::Value &V, StringRef Place, std::string &Out) {
  std::optional<StringRef> Text = V.getAsString();
  if (!Text || Text->empty())
    return wrong(Place, "must be a non-empty string");
  Out = Text->str();
  return Error::success();
}

Error Reader::texts(const json::Value &V, StringRef Place,
                    std::vector<std::string> &Out) {
  const json::Array *List = V.getAsArray();
  if (!List)
    return wrong(Place, "must be a list");
  for (const auto &[N, Item] : enumerate(*List))
    if (Error E =
            text(Item, (Place + "/" + Twine(N)).str(), Out.emplace_back()))
      return E;
  return Error::success();
}

Error Reader::truth(const json::Value &V, StringRef Place, bool &Out) {
  std::optional<bool> B = V.getAsBoolean();
  if (!B)
    return wrong(Place, "must be true or false");
  Out = *B;
  return Error::success();
}

Error Reader::factor(const json::Value &V, StringRef Place, double &Out) {
  std::optional<double> N = V.getAsNumber();
  if (!N || !(*N > 0) || !(*N < std::numeric_limits<double>::infinity()))
    return wrong(Place, "must be a number greater than 0");
  Out = *N;
  return Error::success();
}

Error Reader::numbers(const json::Value &V, StringRef Place,
                      std::vector<unsigned> &Out) {
  const json::Array *List = V.getAsArray();
  if (!List || List->empty())
    return wrong(Place, "must be a non-empty list");
  for (const auto &[N, Item] : enumerate(*List)) {
    std::optional<unsigned> One;
    if (Error E = number(Item, (Place + "/" + Twine(N)).str(), One))
      return E;
    Out.push_back(*One);
  }
  return Error::success();
}

/// A part of a name: the number of an argument, "this", or {"text": ...}.
Error Reader::part(const json::Value &V, StringRef Place, Rule &R) {
  Rule::Part P{Rule::Part::Argument, 0, ""};
  if (V.getAsString() == "this") {
    P.From = Rule::Part::Object;
  } else if (const json::Object *Constant = V.getAsObject()) {
    P.From = Rule::Part::Constant;
    const json::Value *Text = Constant->get("text");
    if (!Text || Constant->size() != 1)
      return wrong(Place, "must have the key \"text\" and no other");
    if (Error E = text(*Text, (Place + "/text").str(), P.Text))
      return E;
  } else {
    std::optional<unsigned> N;
    if (Error E = number(V, Place, N))
      return E;
    P.Number = *N;
  }
  R.Parts.push_back(std::move(P));
  return Error::success();
}

Error Reader::field(StringRef Key, const json::Value &V, StringRef Place,
                    Rule &R) {
  if (Key == "function")
    return text(V, Place, R.Function);
  if (Key == "method")
    return truth(V, Place, R.Method);
  if (Key == "handle")
    return truth(V, Place, R.Handle);
  if (Key == "resolve")
    return text(V, Place, R.Resolve);
  if (Key == "absolute")
    return truth(V, Place, R.Absolute);
  if (Key == "arity")
    return number(V, Place, R.Arity);
  if (Key == "types")
    return texts(V, Place, R.Types);
  if (Key == "name" || Key == "topic")
    return number(V, Place, R.Name);
  if (Key == "default")
    return number(V, Place, R.Default);
  if (Key == "value")
    return V.getAsString() == "return" ? Error::success()
                                       : number(V, Place, R.Value);
  if (Key == "to") {
    if (V.getAsString() == "return" || V.getAsString() == "this") {
      R.Target = V.getAsString() == "this" ? Rule::ToObject : Rule::ToResult;
      return Error::success();
    }
    std::optional<unsigned> N;
    if (Error E = number(V, Place, N))
      return E;
    R.Target = Rule::ToArgument;
    R.TargetArgument = *N;
    return Error::success();
  }
  if (Key == "relation")
    return text(V, Place, R.Relation);
  if (Key == "type")
    return text(V, Place, R.Type);
  if (Key == "answer")
    return text(V, Place, R.Answer);
  if (Key == "slot")
    return number(V, Place, R.Slot);
  if (Key == "symbol")
    return text(V, Place, R.Symbol);
  if (Key == "per_second")
    return factor(V, Place, R.PerSecond);
  if (Key == "nanoseconds")
    return number(V, Place, R.Nanoseconds);
  if (Key == "many") {
    std::optional<StringRef> Text = V.getAsString();
    if (Text != "list" && Text != "map")
      return wrong(Place, "must be \"list\" or \"map\"");
    R.Many = Text == "list" ? Rule::List : Rule::Map;
    return Error::success();
  }
  if (Key == "node")
    return number(V, Place, R.Node);
  if (Key == "rest")
    return number(V, Place, R.Rest);
  if (Key == "callbacks")
    return numbers(V, Place, R.Callbacks);
  assert(Key == "parts" && "a key that no section has");
  const json::Array *Parts = V.getAsArray();
  if (!Parts || Parts->empty())
    return wrong(Place, "must be a non-empty list");
  for (const auto &[N, Item] : enumerate(*Parts))
    if (Error E = part(Item, (Place + "/" + Twine(N)).str(), R))
      return E;
  return Error::success();
}

/// Checks what no single key of the row \p R shows.
Error Reader::meaning(const Rule &R, StringRef Place) {
  static constexpr StringLiteral Resolving[] = {"this", "global", "node"};
  if (R.Kind == Rule::Read && !R.Resolve.empty() &&
      !is_contained(Resolving, R.Resolve))
    return wrong((Place + "/resolve").str(),
                 "must be \"this\", \"global\" or \"node\"");
  if (R.Kind == Rule::Subscription && !R.Name && R.Callbacks.empty())
    return wrong(Place, "must have \"name\", \"callbacks\" or both");
  if (R.Slot.has_value() == R.Symbol.empty())
    return wrong(Place, "must have both \"slot\" and \"symbol\", or neither");
  if (R.Many == Rule::List && R.Value)
    return wrong((Place + "/value").str(),
                 "must be \"return\" where \"many\" is \"list\"");
  if (R.Many == Rule::Map && !R.Value)
    return wrong((Place + "/value").str(),
                 "must be a number where \"many\" is \"map\"");
  // The program reads an integer of 64 bits there.
  if (R.Nanoseconds && *R.Nanoseconds % 8)
    return wrong((Place + "/nanoseconds").str(), "must be a multiple of 8");
  return Error::success();
}

Error Reader::row(const json::Value &V, const Section &In, StringRef Place,
                  RuleFile &Out) {
  const json::Object *Row = V.getAsObject();
  if (!Row)
    return wrong(Place, "must be an object");
  static constexpr StringLiteral Common[] = {"function", "method", "arity",
                                             "types",    "slot",   "symbol"};
  Rule R;
  R.Kind = In.Kind;
  std::vector<std::string> Profiles;
  for (StringRef Key : keysOf(*Row)) {
    std::string At = (Place + "/" + Key).str();
    const json::Value &Field = *Row->get(Key);
    if (Key == "profiles") {
      if (Error E = texts(Field, At, Profiles))
        return E;
    } else if (is_contained(Common, Key) || is_contained(In.Keys, Key)) {
      if (Error E = field(Key, Field, At, R))
        return E;
    } else {
      return wrong(At, "is not a key of a row of \"" + In.Name + "\"");
    }
  }
  if (R.Function.empty())
    return wrong(Place, "has no \"function\"");
  for (StringRef Key : In.Required)
    if (!Row->get(Key))
      return wrong(Place, "has no \"" + Key + "\"");
  if (Error E = meaning(R, Place))
    return E;
  if (belongs(Profiles))
    Out.Rows.push_back(std::move(R));
  return Error::success();
}

Error Reader::containers(const json::Value &V, StringRef Place, RuleFile &Out) {
  const json::Object *Names = V.getAsObject();
  if (!Names)
    return wrong(Place, "must be an object");
  for (StringRef Key : keysOf(*Names)) {
    std::string At = (Place + "/" + Key).str();
    if (Key != "classes" && Key != "reading")
      return wrong(At, "is not a key of \"containers\"");
    if (Error E =
            texts(*Names->get(Key), At,
                  Key == "classes" ? Out.ContainerClasses : Out.ReadingMethods))
      return E;
  }
  return Error::success();
}

Error Reader::overriding(const json::Value &V, StringRef Place, RuleFile &Out) {
  const json::Object *Keys = V.getAsObject();
  if (!Keys)
    return wrong(Place, "must be an object");
  std::vector<std::string> Profiles;
  for (StringRef Key : keysOf(*Keys)) {
    std::string At = (Place + "/" + Key).str();
    std::vector<std::string> *Names =
        StringSwitch<std::vector<std::string> *>(Key)
            .Case("except", &Out.KeptOverrides)
            .Case("tools", &Out.Tools)
            .Case("profiles", &Profiles)
            .Default(nullptr);
    if (!Names)
      return wrong(At, "is not a key of \"overriding\"");
    if (Error E = texts(*Keys->get(Key), At, *Names))
      return E;
  }
  // A user's file that only adds exceptions switches nothing on.
  Out.ShowsOverrides = !Profiles.empty() && belongs(Profiles);
  return Error::success();
}

Error Reader::file(const json::Value &Value, RuleFile &Out) {
  const json::Object *Top = Value.getAsObject();
  if (!Top)
    return wrong("/", "must be an object");
  for (StringRef Key : keysOf(*Top)) {
    std::string Place = ("/" + Key).str();
    const json::Value &V = *Top->get(Key);
    if (Key == "$schema" || Key == "comment") {
      std::string Unused;
      if (Error E = text(V, Place, Unused))
        return E;
    } else if (Key == "schema") {
      if (V.getAsInteger() != 1)
        return wrong(Place, "must be 1");
    } else if (const auto *List = find_if(
                   NameLists, [&](const NameList &L) { return L.Key == Key; });
               List != std::end(NameLists)) {
      if (Error E = texts(V, Place, Out.*List->Names))
        return E;
    } else if (Key == "containers") {
      if (Error E = containers(V, Place, Out))
        return E;
    } else if (Key == "overriding") {
      if (Error E = overriding(V, Place, Out))
        return E;
    } else if (none_of(Sections,
                       [&](const Section &S) { return S.Name == Key; })) {
      return wrong(Place, "is not a section of a rule file");
    }
  }
  for (const Section &S : Sections) {
    const json::Value *V = Top->get(S.Name);
    if (!V)
      continue;
    const json::Array *Rows = V->getAsArray();
    if (!Rows)
      return wrong("/" + S.Name, "must be a list");
    for (const auto &[N, Item] : enumerate(*Rows))
      if (Error E = row(Item, S, ("/" + S.Name + "/" + Twine(N)).str(), Out))
        return E;
  }
  return Error::success();
}

Expected<RuleFile> parseRules(StringRef Text, StringRef Origin,
                              StringRef Profile) {
  Expected<json::Value> Parsed = json::parse(Text);
  if (!Parsed)
    return createStringError(Origin + ": " + toString(Parsed.takeError()));
  RuleFile Out;
  if (Error E = Reader(Origin, Profile).file(*Parsed, Out))
    return std::move(E);
  return Out;
}

} // namespace tpc
