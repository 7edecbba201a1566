//===- PointsTo.h - The locations that a pointer leads to -----------------===//
//
// Pointers are resolved to locations by following them back: through
// getelementptr and phis, from arguments to the calls, from results to the
// returns, and from loads of pointers to the stores of them. This is the
// inclusion-based points-to analysis of Andersen ("Program analysis and
// specialization for the C programming language", 1994, chapter 4), with
// fields, and without contexts except for results that are one of the call's
// own arguments.
//
// Fields are distinguished by class and position, not by object: two objects of
// one class share their fields. Elements of an array are distinguished if their
// index is constant. The elements of a container are one location, however it
// stores them (see `containers` in the rules).
//
// PointsToSolver computes once what arguments, results, phis and pointers in
// memory lead to. All other pointers are followed back to those on request.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_POINTSTO_H
#define TPC_POINTSTO_H

#include "Options.h"
#include "memory/LocationTypes.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"

namespace tpc {

/// The container that \p Call is a method of.
const llvm::Value *containerOf(const llvm::CallBase &Call);

class PointsTo {
public:
  PointsTo(const llvm::DataLayout &Layout, LocationTypes &Types,
           UserSources Sources)
      : Layout(Layout), Types(Types), Sources(std::move(Sources)) {}

  /// The locations that \p Pointer can point to. With \p Scalar, a class is
  /// replaced by the scalar at its beginning: what a load or store of a scalar
  /// touches. Empty if nothing is known.
  Locations resolve(const llvm::Value *Pointer, bool Scalar);

  /// What code that gets \p Pointer can reach: all elements of an array, unless
  /// \p IsOne says that a single object is meant.
  Locations handed(const llvm::Value *Pointer, bool IsOne);

  /// What \p I, memcpy, memmove or memset, reads or writes at \p Pointer: one
  /// element of an array if it covers no more than that.
  Locations covered(const llvm::MemIntrinsic &I, const llvm::Value *Pointer);

  /// What \p I, a load or store, touches: a scalar, or all scalars of the
  /// object that is loaded or stored as one value.
  Locations touched(const llvm::Instruction &I);
  /// The same, with the bits of the register.
  llvm::SmallVector<ScalarPart, 1> partsOf(const llvm::Instruction &I);

  /// Adds the elements of the container that \p Container points to.
  void addElements(const llvm::Value *Container, Locations &Out);

  /// The pointer that \p Pointer is computed from without reading memory.
  static const llvm::Value *baseOf(const llvm::Value *Pointer);

private:
  friend class PointsToSolver;

  void addPointees(const llvm::Value *Pointer, Locations &Out);
  void followChain(Location L, llvm::ArrayRef<const llvm::GEPOperator *> Chain,
                   bool Walks, Locations &Out);
  void addAllocated(const Location &L,
                    llvm::ArrayRef<const llvm::GEPOperator *> Chain, bool Walks,
                    Locations &Out);

  const llvm::DataLayout &Layout;
  LocationTypes &Types;
  UserSources Sources;
  /// What pointers that are not computed on the spot can lead to: arguments,
  /// results, phis, and pointers in memory.
  llvm::DenseMap<const llvm::Value *, Locations> Targets;
  /// Those of them that lead only to their targets.
  llvm::DenseSet<const llvm::Value *> Complete;
};

class PointsToAnalysis : public llvm::AnalysisInfoMixin<PointsToAnalysis> {
public:
  using Result = PointsTo;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<PointsToAnalysis>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-points-to>`
class PointsToPrinter : public llvm::PassInfoMixin<PointsToPrinter> {
public:
  explicit PointsToPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_POINTSTO_H
