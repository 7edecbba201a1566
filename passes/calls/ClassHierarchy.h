//===- ClassHierarchy.h - Where virtual calls go --------------------------===//
//
// Class hierarchy analysis (Dean, Grove and Chambers, "Optimization of
// object-oriented programs using static class hierarchy analysis", ECOOP 1995)
// on the vtables and the type information that the Itanium C++ ABI puts into a
// module.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CLASSHIERARCHY_H
#define TPC_CLASSHIERARCHY_H

#include "support/DebugTypes.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/STLFunctionalExtras.h"
#include "llvm/ADT/SetVector.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/ADT/StringMap.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Module.h"

#include <optional>

namespace tpc {

/// A function in a vtable, and the base classes, by their mangled names,
/// through which a call of this slot enters it.
struct VirtualFunction {
  llvm::Function *F;
  unsigned Slot;
  llvm::ArrayRef<llvm::StringRef> Bases;
};

/// A call through the vtable of an object.
struct VirtualCall {
  const llvm::Value *Object;
  unsigned Slot;
};

class ClassHierarchy {
public:
  explicit ClassHierarchy(llvm::Module &M);

  /// The virtual call that \p Call makes; none if it makes no virtual call.
  static std::optional<VirtualCall> match(const llvm::CallBase &Call);

  /// The functions that the virtual call \p Call can enter: those in its slot
  /// in the vtables of the object's class and of all derived classes. Empty if
  /// the class is not known.
  llvm::SmallVector<llvm::Function *, 4> targets(const llvm::CallBase &Call,
                                                 const VirtualCall &How);

  /// Calls \p Fn for each function in a vtable, in the order of the module.
  void
  forEachFunction(llvm::function_ref<void(const VirtualFunction &)> Fn) const;

  /// Adds the functions in the vtables of the class with the mangled name
  /// \p Name and of all derived classes.
  void addFunctions(llvm::StringRef Name,
                    llvm::SmallSetVector<const llvm::Function *, 4> &Out) const;

  /// Adds the same for all classes whose own name, without scopes and template
  /// arguments, occurs in \p Mangled.
  void addFunctionsOfNamed(
      llvm::StringRef Mangled,
      llvm::SmallSetVector<const llvm::Function *, 4> &Out) const;

private:
  /// The functions behind an address point of a vtable.
  struct Group {
    int64_t Offset; ///< of the part of the object that has this table; bytes
    llvm::SmallVector<llvm::Function *, 8> Functions;
    bool IsFirst; ///< of its table
  };
  /// Another class, and where the base of the two is in the derived one.
  struct Relative {
    unsigned Class;
    int64_t Offset; ///< bytes; Virtual if only the object knows
  };
  static constexpr int64_t Virtual = -1;
  struct Class {
    llvm::StringRef Name; ///< mangled
    /// Of all tables: libraries that are opened may have a class of one name.
    llvm::SmallVector<Group, 1> Table;
    llvm::SmallVector<Relative, 2> Derived, Bases;
  };

  unsigned numberOf(llvm::StringRef Name);
  std::optional<unsigned> find(const llvm::DICompositeType &Class) const;
  void addTable(const llvm::GlobalVariable &Table);
  void addObjects(const llvm::GlobalVariable &Table, unsigned Class);
  void addBases(const llvm::GlobalVariable &TypeInfo);
  void addBasesAt(const Class &C, int64_t Offset,
                  llvm::SmallVectorImpl<llvm::StringRef> &Out) const;
  void collect(unsigned Class, bool AtBeginning, unsigned Slot,
               const llvm::CallBase &Call,
               llvm::SmallVectorImpl<llvm::Function *> &Out);

  llvm::StringMap<unsigned> Numbers; ///< by mangled name
  llvm::SmallVector<Class, 0> Classes;
  /// Classes that have no name outside of their file, found by the objects that
  /// get their tables.
  llvm::DenseMap<const llvm::DICompositeType *, unsigned> OfOneFile;
  DebugTypes Debug;
};

/// True if the types allow \p Call to call \p F.
bool fits(const llvm::CallBase &Call, const llvm::Function &F);

} // namespace tpc

#endif // TPC_CLASSHIERARCHY_H
