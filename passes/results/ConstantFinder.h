//===- ConstantFinder.h - Comparisons with constants ----------------------===//
//
// Thesis, future work: constants in the source that guard an exposing
// statement. Lists the comparisons of a number with a literal, an enumerator, a
// constant that the compiler folded or a constant global, if they decide a
// predicate of the slice by values inside its function or as the result of a
// function that it calls.
//
// Not listed: null pointers; truth values (`flag == true`); `n != 0`, which
// clang also generates for `if (n)` and `if (!n)`; the labels of a switch;
// constants that reach the comparison through a variable.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CONSTANTFINDER_H
#define TPC_CONSTANTFINDER_H

#include "calls/SimpleCallGraph.h"
#include "memory/VisibleWrites.h"
#include "results/GatherResults.h"

#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/STLFunctionalExtras.h"

namespace tpc {

class ConstantFinder {
public:
  /// \p Where returns the place of a comparison in user code; null if it is not
  /// listed.
  ConstantFinder(
      const CallGraphResult &Calls, const LocationTypes &Types,
      PointsTo &Pointers, VisibleWrites &Writes, const SliceResult &Slice,
      llvm::function_ref<const llvm::DILocation *(const llvm::CmpInst &)> Where)
      : Calls(Calls), Types(Types), Pointers(Pointers), Writes(Writes),
        Slice(Slice), Where(Where) {}

  std::vector<Comparison> run(llvm::ArrayRef<llvm::Instruction *> Predicates);

private:
  void searchBack(llvm::Instruction &Predicate, const SliceEntry &E);
  void addComparison(llvm::CmpInst &Compare, llvm::Instruction &Predicate,
                     const SliceEntry &E, bool Direct);

  const llvm::Constant *numberOf(const llvm::Value *V) const;
  const llvm::Constant *returnedBy(const llvm::CallBase &Call) const;
  const llvm::Constant *ofConstMember(const llvm::LoadInst &Load) const;
  std::string nameOf(const llvm::Value *V, bool Unsigned) const;

  const CallGraphResult &Calls;
  const LocationTypes &Types;
  PointsTo &Pointers;
  VisibleWrites &Writes;
  const SliceResult &Slice;
  llvm::function_ref<const llvm::DILocation *(const llvm::CmpInst &)> Where;
  llvm::MapVector<llvm::CmpInst *, Comparison> Found;
};

} // namespace tpc

#endif // TPC_CONSTANTFINDER_H
