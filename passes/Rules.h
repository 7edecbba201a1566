//===- Rules.h - The tables that drive the analysis -----------------------===//
//
// Which calls read a parameter, which expose a node's state, which give a
// publisher its topic and a node handle its namespace: see
// docs/reference/analysis.md. The tables are JSON files (see RuleFile.h). Those
// of TPC (rules/*.json) are compiled in; the user's are added to them.
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
    Read,     ///< reads a parameter
    Exposing, ///< shows what a node has come to
    Topic,    ///< gives a publisher or client its topic
    Naming,   ///< makes a name, or a handle with a namespace
    Accessor, ///< takes the value out of an object that a read gave
    Config,   ///< hands a class of which each field is a parameter
    Text,     ///< compares or copies text
    Held,     ///< puts a number into an object, or takes it out
  };
  /// A piece of what a row of kind Naming makes.
  struct Part {
    enum FromTy { Argument, Object, Constant } From;
    unsigned Number = 0; ///< of the argument
    std::string Text;    ///< of the constant
  };
  enum TargetTy { ToResult, ToObject, ToArgument };

  KindTy Kind;
  std::string Function;          ///< qualified name without template arguments
  bool Method = false;           ///< has a `this`
  std::optional<unsigned> Arity; ///< none: every overload
  /// The parameters' types without const, & and template arguments; `*` is any.
  std::vector<std::string> Types;
  std::optional<unsigned>
      Name; ///< argument with the parameter's or topic's name
  std::optional<unsigned> Value; ///< argument that the value is written to;
                                 ///< none: it is the result
  std::optional<unsigned> Default;
  /// The namespace of `this`, a node handle, stands before the name.
  bool Handle = false;
  std::vector<Part> Parts; ///< joined as names are, by slashes
  /// The name is looked up as it is: no namespace comes before it any more.
  bool Absolute = false;
  TargetTy Target = ToResult;
  unsigned TargetArgument = 0;
  /// Of what is done with text: the operator that the result answers, `compare`
  /// where it is to be compared with zero, `copy` where nothing is asked. Of an
  /// object that holds one number: `into` or `outof`.
  std::string Relation;
};

/// A method of a container of values.
struct ContainerMethod {
  bool Writes; ///< puts its arguments into the container
};

/// The IR operand of \p Call for the source-level argument \p Number of a
/// function that \p R describes; null where there is none.
llvm::Value *argument(const llvm::CallBase &Call, const Rule &R,
                      std::optional<unsigned> Number);

/// The `this` operand of \p Call; null for a function that is no method.
llvm::Value *objectOf(const llvm::CallBase &Call, const Rule &R);

class Rules {
public:
  /// The built-in tables and \p Opts' files, restricted to its profile.
  static llvm::Expected<Rules> load(const Options &Opts);

  /// What the tables say of a function.
  struct Match {
    std::string Name; ///< qualified, without template arguments
    const Rule *Row = nullptr;
    bool Opaque = false; ///< it is in one of the opaque namespaces
    bool Kept = false;   ///< it stays a call that is looked into
    /// What it does to a container; none where it is no method of one.
    std::optional<ContainerMethod> Container;
  };
  const Match &match(const llvm::Function &F) const;
  /// True where the class called \p Name is in one of the opaque namespaces.
  bool isOpaque(llvm::StringRef Name) const;
  /// True where comparisons in a function of this qualified name are its
  /// caller's.
  bool isTransparent(llvm::StringRef Name) const {
    return Transparent.contains(Name);
  }

  /// True where a function of this qualified name only counts who still needs
  /// an object.
  bool isCounting(llvm::StringRef Name) const;

private:
  const Rule *rowOf(const llvm::Function &F, llvm::StringRef Name) const;

  llvm::StringMap<std::vector<Rule>> ByName;
  std::vector<std::string> OpaquePrefixes, KeptPrefixes, CountingPrefixes;
  llvm::StringSet<> ContainerClasses, ReadingMethods, Transparent;
  /// By mangled name: each is demangled once.
  mutable llvm::StringMap<Match> Known;
};

/// The tables of a link; empty ones, and why, where they cannot be read.
struct RuleTables {
  std::shared_ptr<const Rules> Tables;
  std::string Error;

  /// No pass changes the tables.
  bool invalidate(llvm::Module &, const llvm::PreservedAnalyses &,
                  llvm::ModuleAnalysisManager::Invalidator &) {
    return false;
  }
};

/// Reads the tables. A manager for a copy of the module is given those of the
/// module that was copied: they are read, and names are demangled, once.
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
  /// Makes opaque the methods of containers that call nothing of the user's.
  void closeContainers(const Options &Opts);

  /// The row that the callee of \p Call matches, or null.
  const Rule *match(const llvm::CallBase &Call) const;
  /// True where \p F is not looked into: a row stands for it, or its name
  /// begins with one that the tables call opaque.
  bool isOpaque(const llvm::Function &F) const {
    return Rows.contains(&F) || Opaque.contains(&F);
  }
  /// True where the class called \p Name is in one of the opaque namespaces.
  bool isOpaque(llvm::StringRef Name) const { return Tables->isOpaque(Name); }
  /// See Rules::isTransparent; \p F may have been inlined.
  bool isTransparent(const llvm::DISubprogram &F) const {
    return inlined(F).Transparent;
  }
  /// See Rules::isCounting; \p F may have been inlined.
  bool isCounting(const llvm::DISubprogram &F) const {
    return inlined(F).Counting;
  }
  /// The container's method that \p Call calls, or null.
  const ContainerMethod *container(const llvm::CallBase &Call) const;
  /// True where \p F stays a call, however small it is.
  bool staysCall(const llvm::Function &F) const {
    return isOpaque(F) || Kept.contains(&F) || Containers.contains(&F);
  }
  /// True where \p F is looked into as a call of its own: it holds functions or
  /// what is bound to them.
  bool isKept(const llvm::Function &F) const { return Kept.contains(&F); }

private:
  /// What the tables say of a function that may be there no more.
  struct Inlined {
    bool Transparent = false, Counting = false;
  };
  const Inlined &inlined(const llvm::DISubprogram &F) const;

  std::shared_ptr<const Rules> Tables;
  llvm::DenseMap<const llvm::Function *, const Rule *> Rows;
  llvm::DenseSet<const llvm::Function *> Opaque, Kept;
  llvm::MapVector<const llvm::Function *, ContainerMethod> Containers;
  /// Each name is demangled once.
  mutable llvm::DenseMap<const llvm::DISubprogram *, Inlined> InlinedFunctions;
};

/// Calls \p F with each call in \p M that a row of \p Kind describes, and with
/// the row; in the order of the module. What is inside a described function
/// is ROS's own.
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
