//===- ClassObjectAccess.h - Which code reads and writes a variable -------===//
//
// Thesis A.6: field -> its loads and stores. Here a variable is a Location: a
// field of any object of its class, or a global or local variable or a part of
// one.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CLASSOBJECTACCESS_H
#define TPC_CLASSOBJECTACCESS_H

#include "calls/SimpleCallGraph.h"
#include "memory/LocationIndex.h"
#include "memory/PointsTo.h"
#include "memory/Reaching.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/SetVector.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/ADT/StringMap.h"
#include "llvm/IR/DerivedTypes.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/PassManager.h"

#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace tpc {

/// A load, a store, a copy of a whole object, or a call that gets a pointer to
/// it and whose body is not known.
struct Access {
  llvm::Instruction *I;
  Location Where;
};

class AccessResult {
public:
  AccessResult(const llvm::DataLayout &Layout, LocationTypes &Types,
               const Aliases &Alias, PointsTo &Pointers)
      : Layout(Layout), Types(Types), Alias(Alias), Pointers(Pointers),
        LoadIndex(Alias), StoreIndex(Alias), HandedIndex(Alias),
        CopiesTo(Alias, Types), CopiesFrom(Alias, Types),
        WritesByObject(Alias, Types) {}

  /// True where copies of whole objects can bring what is at \p From to \p To,
  /// or the two can be the same.
  bool reaches(const Location &From, const Location &To) const;

  /// The writes that can give \p Load its value: stores, and calls without a
  /// body that are handed the variable. Copies of whole objects are followed.
  /// Writes that another one surely replaces on every way to the load are left
  /// out.
  llvm::ArrayRef<llvm::Instruction *>
  definitionsOf(const llvm::LoadInst &Load) const;

  /// The copies of whole objects by which \p L, or what is copied to it, gets
  /// its value.
  llvm::SmallVector<llvm::Instruction *, 4> copiesTo(const Location &L) const;

  /// True where \p At, which reads \p L at \p Pointer, sees the same writes as
  /// all that reads it elsewhere: it is no local variable of \p At's function,
  /// and no write of it is replaced where others do not see it.
  bool isSharedBy(const Location &L, const llvm::Instruction &At,
                  const llvm::Value *Pointer) const;

  /// The loads to which \p Write, a store or call that writes the scalar at
  /// \p Pointer, can give the value.
  llvm::SmallVector<llvm::LoadInst *, 8>
  usesOf(const llvm::Instruction &Write, const llvm::Value *Pointer) const;

  /// The writes of the scalar at \p L that \p At, which reads it at \p Pointer,
  /// can see.
  llvm::SmallVector<llvm::Instruction *, 8>
  writesOf(const Location &L, const llvm::Instruction &At,
           const llvm::Value *Pointer) const;

  /// Stores into the object at \p L, and calls that are handed it or a part
  /// of it.
  llvm::SmallVector<llvm::Instruction *, 8> writesInto(const Location &L) const;
  /// The same for \p At, which is handed the object by \p Pointer, without
  /// writes that others surely replace before \p At.
  llvm::SmallVector<llvm::Instruction *, 8>
  writesInto(const Location &L, const llvm::Instruction &At,
             const llvm::Value *Pointer) const;

  /// True where \p Call gives what is at \p Pointer a new value, whatever was
  /// there.
  bool replaces(const llvm::CallBase &Call, const llvm::Value *Pointer) const;

  /// True where \p Arg is only put into a container.
  bool isPutIn(const llvm::Use &Arg) const { return PutIn.contains(&Arg); }

  llvm::ArrayRef<Access> loads() const { return Loads; }
  llvm::ArrayRef<Access> stores() const { return Stores; }

  /// How often it was not looked which reads see a write, for the unit is too
  /// large: there, all do.
  unsigned givenUp() const { return GivenUp + Flow->givenUp(); }

private:
  friend class ClassObjectAccess;
  struct Copy {
    llvm::Instruction *I;
    Locations To, From;
  };
  struct Builder;
  using Writes = llvm::SmallSetVector<llvm::Instruction *, 8>;
  void collectWrites(const Location &L, Writes &Own, Writes &Copied) const;
  Writes allWrites(const Location &L) const;
  void collectLoads(const Location &L,
                    llvm::SmallSetVector<llvm::LoadInst *, 8> &Own,
                    llvm::SmallSetVector<llvm::LoadInst *, 8> &Copied) const;
  Locations throughCopies(const Location &L, bool Backward) const;
  void reachingWrites(const llvm::Instruction &At, const Location &L,
                      Writes &W) const;
  bool isOneScalar(const Location &L, const llvm::StoreInst &Store) const;
  bool replaces(const llvm::Instruction &Write, const Location &L) const;
  const llvm::Value *placeOf(const llvm::Instruction &I) const;
  std::optional<Reaching::Variable> variableAt(const llvm::Value *Pointer,
                                               const Location &L) const;
  std::optional<Reaching::Variable> writtenBy(const llvm::Instruction &Write,
                                              const Location &L) const;
  /// A part of an object, and how a function names it.
  struct Part {
    llvm::SmallVector<Step, 4> Way;
    Reaching::Variable Variable;
  };
  llvm::SmallVector<Part, 4> replacedParts(const Location &L,
                                           const llvm::Instruction &At,
                                           const llvm::Value *Pointer) const;
  llvm::SmallVector<unsigned, 16> partsOf(const Location &L) const;
  /// The writes of a variable that is not local.
  struct SharedWrites {
    Writes Own;    ///< of itself
    Writes Copied; ///< of what copies of whole objects put into it
    bool TooMany = false;
    bool Narrowed = false; ///< not all that read it see all of Own
  };
  const SharedWrites &sharedWrites(const Location &L) const;

  std::optional<llvm::SmallVector<llvm::Instruction *, 4>>
  handedTo(const llvm::AllocaInst &Local) const;
  struct LocalHistory;
  const LocalHistory &historyOf(const Location &L,
                                llvm::ArrayRef<llvm::Instruction *> W) const;

  const llvm::DataLayout &Layout;
  LocationTypes &Types;
  const Aliases &Alias;
  PointsTo &Pointers;
  /// The locals whose address another function has stored somewhere.
  llvm::DenseSet<const llvm::Value *> KeptElsewhere;
  llvm::SmallVector<Access, 0> Loads, Stores;
  llvm::SmallVector<Access, 0> Handed; ///< calls without a known body
  llvm::SmallVector<Copy, 0> Copies;
  LocationIndex LoadIndex, StoreIndex, HandedIndex;
  ObjectIndex CopiesTo, CopiesFrom;
  /// Of all writes, numbered as they stand in PartWrites.
  PartIndex WritesByObject;
  llvm::SmallVector<Access, 0> PartWrites;
  mutable llvm::DenseMap<
      const llvm::LoadInst *,
      std::unique_ptr<llvm::SmallVector<llvm::Instruction *, 8>>>
      Definitions;
  mutable llvm::DenseMap<
      const llvm::Value *,
      llvm::SmallVector<
          std::pair<Location, std::shared_ptr<const LocalHistory>>, 1>>
      Histories;
  mutable llvm::DenseMap<const llvm::Instruction *, const llvm::Value *> Places;
  mutable unsigned Walked = 0, GivenUp = 0;
  std::unique_ptr<Reaching> Flow;
  /// Calls that replace a whole variable, and which.
  llvm::DenseMap<const llvm::Instruction *, Location> Replaced;
  /// Arguments that go into a container.
  llvm::DenseSet<const llvm::Use *> PutIn;
  mutable std::map<Location, SharedWrites, LocationOrder> Shared;
};

class ClassObjectAccess : public llvm::AnalysisInfoMixin<ClassObjectAccess> {
public:
  using Result = AccessResult;
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

#endif // TPC_CLASSOBJECTACCESS_H
