//===- CalledBack.h - What a library may call back ------------------------===//
//
// A function without a body can call the virtual functions of an object that it
// gets, and the functions whose addresses the object stores, as std::function
// does. The debug information says what an object is and contains. For an
// instance of a template its arguments count too, so that a shared_ptr passes
// on the object that it owns. Other pointers inside an object are not followed.
// If nothing is known about an object, the mangled name of the function lists
// the classes that it can have.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CALLEDBACK_H
#define TPC_CALLEDBACK_H

#include "calls/ClassHierarchy.h"
#include "support/DebugTypes.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/SetVector.h"

#include <memory>
#include <optional>

namespace tpc {

class CalledBack {
public:
  CalledBack(llvm::Module &M, DebugTypes &Debug) : M(M), Debug(Debug) {}

  /// What code that has an object can call.
  struct Callable {
    llvm::SmallSetVector<const llvm::Function *, 4> Virtual;
    bool Kept = false;    ///< any function whose address was passed on
    bool Unknown = false; ///< virtual functions of a class without a name
  };

  /// For each object that \p Call passes to a function without a body: what can
  /// be called through it.
  llvm::SmallVector<const Callable *, 2> handedBy(const llvm::CallBase &Call);
  /// The same for the object that \p Call passes as \p Arg; null if it passes
  /// none, or not to such a function.
  const Callable *handedAs(const llvm::CallBase &Call, const llvm::Use &Arg);

private:
  const Callable &ofType(const llvm::DIType *T);
  const Callable &ofParameters(const llvm::Function &F);
  const ClassHierarchy &classes();
  void addClass(const llvm::DICompositeType &Class, Callable &Out);

  llvm::Module &M;
  DebugTypes &Debug;
  std::optional<ClassHierarchy> Classes; ///< created when first needed
  llvm::DenseMap<const llvm::DIType *, std::unique_ptr<Callable>> ByType;
  llvm::DenseMap<const llvm::Function *, std::unique_ptr<Callable>> ByFunction;
};

class CalledBackAnalysis : public llvm::AnalysisInfoMixin<CalledBackAnalysis> {
public:
  using Result = CalledBack;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM) {
    return CalledBack(M, AM.getResult<DebugTypesAnalysis>(M));
  }

private:
  friend llvm::AnalysisInfoMixin<CalledBackAnalysis>;
  static llvm::AnalysisKey Key;
};

} // namespace tpc

#endif // TPC_CALLEDBACK_H
