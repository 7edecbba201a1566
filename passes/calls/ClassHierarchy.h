//===- ClassHierarchy.h - Where virtual calls go --------------------------===//
//
// Class hierarchy analysis (Dean, Grove and Chambers, "Optimization of
// object-oriented programs using static class hierarchy analysis", ECOOP 1995)
// on what the Itanium C++ ABI leaves in a module: the vtables, and the type
// information that says who derives from whom.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CLASSHIERARCHY_H
#define TPC_CLASSHIERARCHY_H

#include "support/DebugTypes.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/SetVector.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/ADT/StringMap.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Module.h"

#include <optional>

namespace tpc {

/// A call through an object's table of virtual functions.
struct VirtualCall {
  const llvm::Value *Object;
  unsigned Slot;
};

class ClassHierarchy {
public:
  explicit ClassHierarchy(llvm::Module &M);

  /// What kind of virtual call \p Call is; none where it is not one.
  static std::optional<VirtualCall> match(const llvm::CallBase &Call);

  /// The functions that \p Call, a virtual one, can enter: those that stand in
  /// its slot in the tables of the object's class and of what derives from it.
  /// Empty where the class is not known.
  llvm::SmallVector<llvm::Function *, 4> targets(const llvm::CallBase &Call,
                                                 const VirtualCall &How);

  /// Adds the functions that stand in the tables of the class \p Name, as it is
  /// mangled, and of what derives from it.
  void addFunctions(llvm::StringRef Name,
                    llvm::SmallSetVector<const llvm::Function *, 4> &Out) const;

  /// The same for all classes whose own name, without scopes and arguments, is
  /// in \p Mangled.
  void addFunctionsOfNamed(
      llvm::StringRef Mangled,
      llvm::SmallSetVector<const llvm::Function *, 4> &Out) const;

private:
  /// A table: the functions behind each of its address points.
  using Table = llvm::SmallVector<llvm::SmallVector<llvm::Function *, 8>, 1>;
  struct Class {
    llvm::StringRef Name; ///< as it is mangled
    Table Functions;
    /// Classes that derive from it, and whether it stands at their beginning.
    llvm::SmallVector<std::pair<unsigned, bool>, 2> Derived;
  };

  unsigned numberOf(llvm::StringRef Name);
  std::optional<unsigned> find(const llvm::DICompositeType &Class) const;
  void addTable(const llvm::GlobalVariable &Table);
  void addObjects(const llvm::GlobalVariable &Table, unsigned Class);
  void addBases(const llvm::GlobalVariable &TypeInfo);
  void collect(unsigned Class, bool AtBeginning, unsigned Slot,
               const llvm::CallBase &Call,
               llvm::SmallVectorImpl<llvm::Function *> &Out);

  llvm::StringMap<unsigned> Numbers; ///< by the name as it is mangled
  llvm::SmallVector<Class, 0> Classes;
  /// Classes that have no name across files, by the objects that are given
  /// their tables.
  llvm::DenseMap<const llvm::DICompositeType *, unsigned> OfOneFile;
  DebugTypes Debug;
};

/// True where \p Call can be a call of \p F by their types.
bool fits(const llvm::CallBase &Call, const llvm::Function &F);

} // namespace tpc

#endif // TPC_CLASSHIERARCHY_H
