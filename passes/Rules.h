//===- Rules.h - The tables that drive the analysis -----------------------===//
//
// SPEC 2: which calls read a parameter, which expose a node's state, which
// give a publisher its topic. Data, read from JSON; the tables that come with
// TPC are built in (rules/*.json), the user's are added to them.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_RULES_H
#define TPC_RULES_H

#include "Functions.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/StringMap.h"
#include "llvm/ADT/StringSet.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/PassManager.h"
#include "llvm/Support/Error.h"

#include <optional>
#include <string>
#include <vector>

namespace tpc {

struct Options;

/// One row. Argument numbers count the parameters as written in the source.
struct Rule {
  enum KindTy { Read, Exposing, Topic, Text, Held };
  KindTy Kind;
  std::string Function;          ///< qualified name without template arguments
  bool Method = false;           ///< has a `this`
  std::optional<unsigned> Arity; ///< none: every overload
  std::optional<unsigned>
      Name; ///< argument with the parameter's or topic's name
  std::optional<unsigned> Value; ///< argument that the value is written to;
                                 ///< none: it is the result
  std::optional<unsigned> Default;
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

  /// The row for \p F, or null.
  const Rule *match(const llvm::Function &F) const;
  /// True where \p F is in one of the opaque namespaces.
  bool isOpaque(const llvm::Function &F) const;
  bool isOpaque(llvm::StringRef Name) const; ///< the same of a class
  /// True where comparisons in a function of this qualified name are its
  /// caller's.
  bool isTransparent(llvm::StringRef Name) const {
    return Transparent.contains(Name);
  }
  /// What \p F does to a container; none where it is no method of one.
  std::optional<ContainerMethod> container(const llvm::Function &F) const;
  /// True where \p F stays a call that is looked into.
  bool isKept(const llvm::Function &F) const;

private:
  llvm::Error add(llvm::StringRef Json, llvm::StringRef Origin,
                  llvm::StringRef Profile);
  llvm::StringMap<std::vector<Rule>> ByName;
  std::vector<std::string> OpaquePrefixes, KeptPrefixes;
  llvm::StringSet<> ContainerClasses, ReadingMethods, Transparent;
};

/// The rules applied to the functions of a module.
class RuleMatches {
public:
  /// The row that the callee of \p Call matches, or null.
  const Rule *match(const llvm::CallBase &Call) const;
  /// True where \p F is not looked into: a row stands for it, or its name
  /// begins with one that the tables call opaque.
  bool isOpaque(const llvm::Function &F) const {
    return Rows.contains(&F) || Opaque.contains(&F);
  }
  /// True where the class called \p Name is in one of the opaque namespaces.
  bool isOpaque(llvm::StringRef Name) const {
    return Tables && Tables->isOpaque(Name);
  }
  /// See Rules::isTransparent.
  bool isTransparent(llvm::StringRef Name) const {
    return Tables && Tables->isTransparent(Name);
  }
  /// The container's method that \p Call calls, or null.
  const ContainerMethod *container(const llvm::CallBase &Call) const;
  std::string Error; ///< why the tables could not be read; else empty

private:
  friend class RuleAnalysis;
  std::shared_ptr<const Rules> Tables;
  llvm::DenseMap<const llvm::Function *, const Rule *> Rows;
  llvm::DenseSet<const llvm::Function *> Opaque;
  llvm::DenseMap<const llvm::Function *, ContainerMethod> Containers;
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
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &);

private:
  friend llvm::AnalysisInfoMixin<RuleAnalysis>;
  static llvm::AnalysisKey Key;
};

} // namespace tpc

#endif // TPC_RULES_H
