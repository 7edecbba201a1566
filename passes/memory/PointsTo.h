//===- PointsTo.h - The locations that a pointer leads to -----------------===//
//
// Pointers are resolved to locations by following them back through
// getelementptr, phis, arguments to the calls, results to the returns, and
// loads of pointers to the stores of them: inclusion-based points-to analysis
// as Andersen's ("Program analysis and specialization for the C programming
// language", 1994, chapter 4), with fields, without contexts but for results
// that are one of the call's own arguments.
//
// Fields are told apart by class and position, not by object: two objects of
// one class share their fields. Elements of an array are told apart where their
// index is constant; those of a container are one location, however it keeps
// them (see the rules' containers).
//
// What the pointers lead to that are not computed on the spot is found once, by
// PointsToSolver; the others are followed to those when they are asked for.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_POINTSTO_H
#define TPC_POINTSTO_H

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
  PointsTo(const llvm::DataLayout &Layout, LocationTypes &Types)
      : Layout(Layout), Types(Types) {}

  /// The locations that \p Pointer can point to. With \p Scalar a class is
  /// entered down to the scalar at its beginning: what a load or store of a
  /// scalar touches. Empty where nothing is known.
  Locations resolve(const llvm::Value *Pointer, bool Scalar);

  /// What can be reached from \p Pointer by one who is handed it: of an array
  /// all elements, unless \p IsOne says that just an object is meant.
  Locations handed(const llvm::Value *Pointer, bool IsOne);

  /// What \p Copy takes from or puts to \p Pointer: one element where it is no
  /// larger than that.
  Locations copied(const llvm::MemTransferInst &Copy,
                   const llvm::Value *Pointer);

  /// What \p I, a load or store, touches: a scalar, or all scalars of what is
  /// loaded or stored as one value.
  Locations touched(const llvm::Instruction &I);
  /// The same with the bits of the register.
  llvm::SmallVector<ScalarPart, 1> partsOf(const llvm::Instruction &I);

  /// Adds the elements of the container that \p Container points to.
  void addElements(const llvm::Value *Container, Locations &Out);

private:
  friend class PointsToSolver;

  static const llvm::Value *baseOf(const llvm::Value *Pointer);
  void addPointees(const llvm::Value *Pointer, Locations &Out);
  void followChain(Location L, llvm::ArrayRef<const llvm::GEPOperator *> Chain,
                   bool Walks, Locations &Out);
  void addAllocated(const Location &L,
                    llvm::ArrayRef<const llvm::GEPOperator *> Chain,
                    Locations &Out);

  const llvm::DataLayout &Layout;
  LocationTypes &Types;
  /// What the pointers that are not computed on the spot can lead to:
  /// arguments, results, merges, and pointers that were in memory.
  llvm::DenseMap<const llvm::Value *, Locations> Targets;
  /// Those of them that lead to nothing else than their targets.
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
