//===- CalledBack.h - What a library may call back ------------------------===//
//
// A function without a body can call the virtual functions of an object that it
// is handed, and functions that the object keeps the addresses of, as
// std::function does. What an object is and has in it, its debug information
// says; of a template's instance its arguments do, too, so that a shared_ptr
// hands on what it leads to. Other pointers in it are not followed. Of an
// object about which nothing is known, the mangled name says of which classes
// it can be.
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

  /// What can be called by one who has an object.
  struct Callable {
    llvm::SmallSetVector<const llvm::Function *, 4> Virtual;
    bool Kept = false;    ///< any function whose address was handed on
    bool Unknown = false; ///< virtual functions of a class that has no name
  };

  /// The objects that \p Call, of a function without a body, hands over: what
  /// can be called of each.
  llvm::SmallVector<const Callable *, 2> handedBy(const llvm::CallBase &Call);

private:
  const Callable &ofType(const llvm::DIType *T);
  const Callable &ofParameters(const llvm::Function &F);
  const ClassHierarchy &classes();
  void addClass(const llvm::DICompositeType &Class, Callable &Out);

  llvm::Module &M;
  DebugTypes &Debug;
  std::optional<ClassHierarchy> Classes; ///< once it is needed
  llvm::DenseMap<const llvm::DIType *, std::unique_ptr<Callable>> ByType;
  llvm::DenseMap<const llvm::Function *, std::unique_ptr<Callable>> ByFunction;
};

} // namespace tpc

#endif // TPC_CALLEDBACK_H
