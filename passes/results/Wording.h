//===- Wording.h - Describes the program in words of its source -----------===//
//
// For people who read why a comparison is reported, and where the analysis has
// blind spots: the names of functions and variables as the source has them, and
// the places in user code that library code stands for.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_WORDING_H
#define TPC_WORDING_H

#include "Options.h"
#include "memory/PointsTo.h"
#include "memory/Variables.h"
#include "slice/ExternCallFinder.h"

namespace tpc {

class Wording {
public:
  Wording(const LocationTypes &Types, PointsTo &Pointers,
          const ExternCallFinder::Result &Exposing, const Options &Opts);

  /// The line of user code that \p I belongs to: its own or, if \p I was
  /// inlined from a library function, that of the call. Null for library code.
  const llvm::DILocation *userPlace(const llvm::Instruction &I);

  /// `Node::limit_`; empty if it has no name.
  std::string variable(const llvm::Value *Pointer) const;
  /// The same for a whole object.
  std::string object(const llvm::Value *Pointer) const;
  /// The variable, constant or call that \p V is; empty if it is none of these.
  std::string value(const llvm::Value *V) const;
  /// \p Before and, for example, `into Node::limit_`; without the name if there
  /// is none.
  static std::string with(const std::string &Before,
                          llvm::StringRef Preposition, const std::string &Name);
  std::string argument(const llvm::Argument &Arg) const;
  /// `published on /camera`
  std::string exposed(const ExposingStatement &E) const;
  /// What a predicate can guard: `publish() on /camera`, `the call of f()`,
  /// `the store to Node::state_`, `line 12`.
  std::string guarded(const llvm::Instruction &I);

private:
  std::string nameOf(const llvm::Value *Pointer, bool Scalar) const;

  PointsTo &Pointers;
  UserSources Sources;
  VariableNames Names;
  llvm::DenseMap<const llvm::Instruction *, const ExposingStatement *> Exposing;
};

} // namespace tpc

#endif // TPC_WORDING_H
