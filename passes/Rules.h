//===- Rules.h - The rules that drive the analysis ------------------------===//
//
// The tables say which calls read a parameter, which expose the state of a
// node, which give a publisher its topic and which give a node handle its
// namespace: docs/reference/analysis.md. They are JSON files (see RuleFile.h).
// TPC's own tables (rules/*.json) are compiled in; those of the user are added
// to them.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_RULES_H
#define TPC_RULES_H

#include "support/Functions.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/StringMap.h"
#include "llvm/ADT/StringSet.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/PassManager.h"
#include "llvm/Support/Error.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tpc {

struct Options;

/// One row. Argument numbers count the parameters as written in the source.
struct Rule {
  enum KindTy {
    Read,         ///< reads a parameter
    Exposing,     ///< makes the state of a node visible
    Topic,        ///< gives a publisher or client its topic
    Naming,       ///< makes a name, or a node handle with a namespace
    Accessor,     ///< takes the value out of an object that a read returned
    Config,       ///< passes a class whose fields are all parameters
    Text,         ///< compares or copies text
    Held,         ///< puts a number into an object, or takes it out
    Property,     ///< says something about a list or struct, such as its size
    Identity,     ///< returns the name of a parameter that an object holds
    Callback,     ///< keeps functions that it calls later
    Subscription, ///< calls functions with the messages of a topic
  };
  /// A part of the name that a row of kind Naming makes.
  struct Part {
    enum FromTy { Argument, Object, Constant } From;
    unsigned Number = 0; ///< of the argument
    std::string Text;    ///< of the constant
  };
  enum TargetTy { ToResult, ToObject, ToArgument };

  KindTy Kind;
  std::string Function;          ///< qualified name without template arguments
  bool Method = false;           ///< has a `this`
  std::optional<unsigned> Arity; ///< unset: all overloads
  /// The types of the parameters without const, & and template arguments; `*`
  /// matches any type.
  std::vector<std::string> Types;
  /// The argument that holds the name of the parameter or topic.
  std::optional<unsigned> Name;
  std::optional<unsigned> Value; ///< argument that the value is written to;
                                 ///< unset: the value is the result
  std::optional<unsigned> Default;
  /// The read is of several parameters: Name is a list of names and the value a
  /// list of objects, or Name is a prefix and the value a map.
  enum ManyTy { One, List, Map } Many = One;
  /// The namespace of `this`, a node handle, is put before the name.
  bool Handle = false;
  /// Which handle resolves the name in the running node: `this`, `global`, or
  /// a field of `this`; empty if none is known.
  std::string Resolve;
  std::vector<Part> Parts; ///< joined with slashes
  /// The name is looked up as it is: no namespace is put before it.
  bool Absolute = false;
  TargetTy Target = ToResult;
  unsigned TargetArgument = 0;
  /// For text: the operator that the result stands for, `compare` if the result
  /// is to be compared with zero, `copy` if the call copies text. For an object
  /// that holds a number: `into` or `outof`. For a property: its name.
  std::string Relation;
  /// For an object that holds a number: how many units of the number of the
  /// call are one of those that are held: 1e9 for nanoseconds.
  double PerSecond = 1;
  /// For `into`: the argument with nanoseconds that are put in, too.
  std::optional<unsigned> Rest;
  /// For operators of such objects: where an object has its nanoseconds, an
  /// integer of 64 bits, in bytes; unset: it begins with two integers of 32
  /// bits, seconds and nanoseconds.
  std::optional<unsigned> Nanoseconds;
  /// The type of the result, where neither the function's name nor the code
  /// tells; empty if they do.
  std::string Type;
  /// The arguments that are functions. If Name is set, they are called with an
  /// object that holds this parameter; otherwise what they return is seen.
  std::vector<unsigned> Callbacks;
  /// The argument that names the node whose parameter Name is; empty or not
  /// constant for the own node.
  std::optional<unsigned> Node;
  /// What the name of a class contains to which such a function gets a smart
  /// pointer, and whose contents are seen: the answer of a service. Empty if
  /// there is none.
  std::string Answer;
  /// For a virtual function whose class the debug information may lack: its
  /// number in the table of virtual functions, and its mangled name.
  std::optional<unsigned> Slot;
  std::string Symbol;
};

/// A method of a container.
struct ContainerMethod {
  bool Writes;    ///< puts its arguments into the container
  bool IsElement; ///< returns an element, or a reference to one
};

/// The IR operand of \p Call for the argument that the source counts as
/// \p Number; null if there is none. \p R describes the called function.
llvm::Value *argument(const llvm::CallBase &Call, const Rule &R,
                      std::optional<unsigned> Number);

/// The `this` operand of \p Call; null if the function is not a method.
llvm::Value *objectOf(const llvm::CallBase &Call, const Rule &R);

/// The object that \p Call, described by a row of kind Held, puts a number into
/// or takes one out of: `this`, or what a function that is not a method makes;
/// null if that is not known.
llvm::Value *holderOf(const llvm::CallBase &Call, const Rule &R);

class Rules {
public:
  /// The built-in tables and the files of \p Opts, restricted to its profile.
  static llvm::Expected<Rules> load(const Options &Opts);

  /// What the tables say about a function.
  struct Match {
    std::string Name; ///< qualified, without template arguments
    const Rule *Row = nullptr;
    bool Opaque = false; ///< in one of the opaque namespaces
    bool Kept = false;   ///< stays a call whose body is analysed
    /// What the function does to a container; unset if it is not a container's
    /// method.
    std::optional<ContainerMethod> Container;
  };
  const Match &match(const llvm::Function &F) const;
  /// The mangled name that a row gives the virtual function in \p Slot of the
  /// class with the qualified name \p Class; empty if none does.
  llvm::StringRef symbolAt(llvm::StringRef Class, unsigned Slot) const;
  /// True if there are rows for functions with the qualified name of the
  /// function \p Mangled.
  bool hasRow(llvm::StringRef Mangled) const;
  /// True if the class \p Name is in one of the opaque namespaces.
  bool isOpaque(llvm::StringRef Name) const;
  /// True if comparisons inside a function of this qualified name count as
  /// comparisons of its caller.
  bool isTransparent(llvm::StringRef Name) const {
    return Transparent.contains(Name);
  }

  /// True for the qualified name of a container class.
  bool isContainer(llvm::StringRef Class) const {
    return ContainerClasses.contains(Class);
  }

  /// True if a function of this qualified name only counts references to an
  /// object.
  bool isCounting(llvm::StringRef Name) const;

  /// True if a function of this qualified name only ends the life of an object:
  /// what it calls through a pointer are destructors.
  bool isDestroying(llvm::StringRef Name) const;

  /// True if what a function of this qualified name publishes is about the
  /// library that it belongs to, not about the robot.
  bool isSilent(llvm::StringRef Name) const;

  /// True if functions that override a virtual function of another library
  /// expose what they return and write.
  bool showsOverrides() const { return ShowsOverrides; }
  /// True if those of the class with the mangled name \p Class do not.
  bool keepsOverrides(llvm::StringRef Class) const;
  /// The qualified names of the classes that are nodes of ROS 2, sorted.
  std::vector<std::string> nodeClasses() const;
  /// True if an object of the class with the qualified name \p Class is a tool
  /// that an overriding function is handed, not a part of the robot.
  bool isTool(llvm::StringRef Class) const;

private:
  const Rule *rowOf(const llvm::Function &F, llvm::StringRef Name) const;

  llvm::StringMap<std::vector<Rule>> ByName;
  std::vector<std::string> OpaquePrefixes, KeptPrefixes, CountingPrefixes,
      DestroyingPrefixes, SilentPrefixes, KeptOverrides, Tools;
  bool ShowsOverrides = false;
  llvm::StringSet<> ContainerClasses, ReadingMethods, Transparent;
  /// Cached by mangled name, so that each name is demangled once.
  mutable llvm::StringMap<Match> Known;
  llvm::StringMap<std::string> Symbols; ///< by class and slot: `ns::Class 7`
};

/// The tables of a link; if they cannot be read, empty tables and the reason.
struct RuleTables {
  std::shared_ptr<const Rules> Tables;
  std::string Error;

  /// No pass changes the tables.
  bool invalidate(llvm::Module &, const llvm::PreservedAnalyses &,
                  llvm::ModuleAnalysisManager::Invalidator &) {
    return false;
  }
};

/// Reads the tables. The manager of a copied module gets the tables of the
/// original module, so that they are read, and names demangled, once.
class RuleTableAnalysis : public llvm::AnalysisInfoMixin<RuleTableAnalysis> {
public:
  using Result = RuleTables;
  RuleTableAnalysis() = default;
  explicit RuleTableAnalysis(RuleTables Known) : Known(std::move(Known)) {}
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<RuleTableAnalysis>;
  static llvm::AnalysisKey Key;
  std::optional<RuleTables> Known;
};

/// The rules applied to the functions of a module.
class RuleMatches {
public:
  RuleMatches(std::shared_ptr<const Rules> Tables, llvm::Module &M);
  /// Makes container methods opaque if they call no user code.
  void closeContainers(const Options &Opts);

  /// The row that matches the callee of \p Call, or null.
  const Rule *match(const llvm::CallBase &Call) const;
  /// The same of a row that describes a subscription. The body of such a
  /// function is analysed.
  const Rule *subscription(const llvm::CallBase &Call) const;
  /// True if the body of \p F is not analysed: a row describes \p F, or its
  /// name begins with an opaque prefix.
  bool isOpaque(const llvm::Function &F) const {
    return Rows.contains(&F) || Opaque.contains(&F);
  }
  /// True if the class \p Name is in one of the opaque namespaces.
  bool isOpaque(llvm::StringRef Name) const { return Tables->isOpaque(Name); }
  bool showsOverrides() const { return Tables->showsOverrides(); }
  bool keepsOverrides(llvm::StringRef Class) const {
    return Tables->keepsOverrides(Class);
  }
  bool isTool(llvm::StringRef Class) const { return Tables->isTool(Class); }
  /// See Rules::isTransparent; works for inlined functions too.
  bool isTransparent(const llvm::DISubprogram &F) const {
    return inlined(F).Transparent;
  }
  /// See Rules::isCounting; works for inlined functions too.
  bool isCounting(const llvm::DISubprogram &F) const {
    return inlined(F).Counting;
  }
  /// See Rules::isDestroying; works for inlined functions too.
  bool isDestroying(const llvm::DISubprogram &F) const {
    return inlined(F).Destroying;
  }
  /// See Rules::isSilent; works for inlined functions too.
  bool isSilent(const llvm::DISubprogram &F) const { return inlined(F).Silent; }
  /// See Rules::isContainer.
  bool isContainer(llvm::StringRef Class) const {
    return Tables->isContainer(Class);
  }
  /// The container method that \p Call calls, or null.
  const ContainerMethod *container(const llvm::CallBase &Call) const;
  /// True if \p F is never inlined, however small it is.
  bool staysCall(const llvm::Function &F) const {
    return isOpaque(F) || Kept.contains(&F) || Containers.contains(&F) ||
           Subscribing.contains(&F);
  }
  /// True if \p F stays a call and its body is analysed: it stores functions or
  /// bound arguments.
  bool isKept(const llvm::Function &F) const { return Kept.contains(&F); }

private:
  /// What the tables say about a function that may have been inlined
  /// everywhere.
  struct Inlined {
    bool Transparent = false, Counting = false, Destroying = false,
         Silent = false;
  };
  const Inlined &inlined(const llvm::DISubprogram &F) const;

  std::shared_ptr<const Rules> Tables;
  llvm::DenseMap<const llvm::Function *, const Rule *> Rows, Subscribing;
  llvm::DenseSet<const llvm::Function *> Opaque, Kept;
  llvm::MapVector<const llvm::Function *, ContainerMethod> Containers;
  /// Each name is demangled once.
  mutable llvm::DenseMap<const llvm::DISubprogram *, Inlined> InlinedFunctions;
};

/// Calls \p F with each call in \p M that a row of \p Kind describes and with
/// that row, in the order of the module. Skips calls inside functions that a
/// row describes: they are part of ROS.
template <typename Fn>
void forEachCall(llvm::Module &M, const RuleMatches &Rules, Rule::KindTy Kind,
                 Fn F) {
  for (llvm::Function &In : definedFunctions(M)) {
    if (Rules.isOpaque(In))
      continue;
    for (llvm::Instruction &I : llvm::instructions(In)) {
      auto *Call = llvm::dyn_cast<llvm::CallBase>(&I);
      const Rule *Row = Call ? Rules.match(*Call) : nullptr;
      if (Row && Row->Kind == Kind)
        F(*Call, *Row);
    }
  }
}

class RuleAnalysis : public llvm::AnalysisInfoMixin<RuleAnalysis> {
public:
  using Result = RuleMatches;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<RuleAnalysis>;
  static llvm::AnalysisKey Key;
};

} // namespace tpc

#endif // TPC_RULES_H
