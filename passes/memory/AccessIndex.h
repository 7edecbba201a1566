//===- AccessIndex.h - Which code reads and writes a variable -------------===//
//
// Thesis A.6: field -> its loads and stores. Here a variable is a Location: a
// field of any object of its class, or a global or local variable or a part of
// one. Copies of whole objects connect variables.
//
// All accesses that may touch the same memory are listed, in whatever order
// they run; VisibleWrites.h decides which write a read sees.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_ACCESSINDEX_H
#define TPC_ACCESSINDEX_H

#include "memory/LocationIndex.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/SetVector.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/PassManager.h"

namespace tpc {

/// A load, a store, a copy of a whole object, a memset, or a call that gets a
/// pointer to the object and whose body is not known.
struct Access {
  llvm::Instruction *I;
  Location Where;
};

/// A call that always gives the \c Bytes at \c Pointer a new value.
struct Replacement {
  const llvm::CallBase *Call;
  const llvm::Value *Pointer;
  uint64_t Bytes;
};

class AccessIndex {
public:
  AccessIndex(const Aliases &Alias, LocationTypes &Types)
      : Alias(Alias), Types(Types), LoadIndex(Alias), StoreIndex(Alias),
        HandedIndex(Alias), TargetIndex(Alias, Types),
        SourceIndex(Alias, Types), WritesByObject(Alias, Types) {}

  llvm::ArrayRef<Access> loads() const { return Loads; }
  llvm::ArrayRef<Access> stores() const { return Stores; }

  using Writes = llvm::SmallSetVector<llvm::Instruction *, 8>;
  using Reads = llvm::SmallSetVector<llvm::LoadInst *, 8>;
  /// Accesses of a variable itself, and of the variables that copies of whole
  /// objects connect it with.
  template <typename Set> struct Found {
    Set Own, Copied;
  };
  /// The writes that can give the variable at \p L its value: stores, memset,
  /// and calls without a body that get a pointer to it.
  Found<Writes> writesOf(const Location &L);
  /// The loads that can read the value of the variable at \p L.
  Found<Reads> readsOf(const Location &L);
  /// The same without copies: the stores to \p L and the loads from it.
  llvm::SmallVector<llvm::StoreInst *, 8> storesAt(const Location &L) const;
  llvm::SmallVector<llvm::LoadInst *, 8> loadsAt(const Location &L) const;

  /// True if copies of whole objects can bring the value at \p From to \p To,
  /// or the two can be the same variable.
  bool reaches(const Location &From, const Location &To);
  /// True if the value at \p L is copied to more variables than reaches() and
  /// readsOf() follow.
  bool isCopiedOn(const Location &L) {
    return throughCopies(L, /*Backward=*/false).IsCut;
  }
  /// The copies of whole objects that give \p L, or variables copied to it, a
  /// value. Any object of a class can be the one that a variable without a root
  /// is in: the copies of a class that is in \p Known are left out, and the
  /// classes of those that are returned are added, so that who collects the
  /// copies of many variables gets those thousands once.
  llvm::SmallVector<llvm::Instruction *, 4>
  copiesTo(const Location &L, llvm::DenseSet<unsigned> &Known);

  /// The writes into the object at \p L, with the location of each: stores,
  /// copies, and calls that get a pointer to the object or to a part of it.
  llvm::ArrayRef<const Access *> partsOf(const Location &L);
  /// The same, each instruction once.
  llvm::SmallVector<llvm::Instruction *, 8> writesInto(const Location &L);

  /// The calls that replace a variable.
  llvm::ArrayRef<Replacement> replacements() const { return Replacements; }
  /// The one variable that \p Call replaces; null if it replaces none, or the
  /// variable is not known.
  const Location *replacedBy(const llvm::Instruction &Call) const;

  /// True if the call does not write what \p Arg points to: it only puts it
  /// into a container, or takes it as pointer to const.
  bool isUnchanged(const llvm::Use &Arg) const {
    return Unchanged.contains(&Arg);
  }

private:
  friend class AccessBuilder;
  struct Copy {
    llvm::Instruction *I;
    Locations To, From;
  };
  /// One of the objects that a copy reads or writes.
  struct CopyEnd {
    unsigned Copy;
    Location Object;
  };
  /// The variables that copies connect with one, itself included; IsCut if
  /// they are not all.
  struct Connected {
    Locations All;
    bool IsCut = false;
  };
  bool isSearchedByClass(const Location &L, const Locations &Found) const;
  const Connected &throughCopies(const Location &L, bool Backward);

  const Aliases &Alias;
  LocationTypes &Types;
  llvm::SmallVector<Access, 0> Loads, Stores;
  llvm::SmallVector<Access, 0>
      Handed; ///< memset, and calls without a known body
  llvm::SmallVector<Copy, 0> Copies;
  llvm::SmallVector<CopyEnd, 0> Targets, Sources;
  /// Cached results: the variables that copies connect with a variable.
  LocationMap<Connected> Backward, Forward;
  LocationIndex LoadIndex, StoreIndex, HandedIndex;
  ObjectIndex TargetIndex, SourceIndex;
  /// Of all writes, numbered as in PartWrites.
  PartIndex WritesByObject;
  llvm::SmallVector<Access, 0> PartWrites;
  /// Cached results of partsOf.
  LocationMap<llvm::SmallVector<const Access *, 0>> Parts;
  llvm::SmallVector<Replacement, 0> Replacements;
  /// Calls that replace a whole variable, and that variable.
  llvm::DenseMap<const llvm::Instruction *, Location> Replaced;
  /// Arguments of calls that do not write what those point to.
  llvm::DenseSet<const llvm::Use *> Unchanged;
};

class ClassObjectAccess : public llvm::AnalysisInfoMixin<ClassObjectAccess> {
public:
  using Result = AccessIndex;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<ClassObjectAccess>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-class-object-access>`
class ClassObjectAccessPrinter
    : public llvm::PassInfoMixin<ClassObjectAccessPrinter> {
public:
  explicit ClassObjectAccessPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_ACCESSINDEX_H
