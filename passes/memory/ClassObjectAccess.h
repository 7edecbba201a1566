//===- ClassObjectAccess.h - Which code reads and writes a variable -------===//
//
// Thesis A.6: field -> its loads and stores. Here a variable is a Location: a
// field of any object of its class, or a global or local variable or a part of
// one. Pointers are resolved to locations by following them back through
// getelementptr, phis, arguments to the calls, results to the returns, and
// loads of pointers to the stores of them: inclusion-based points-to analysis
// as Andersen's ("Program analysis and specialization for the C programming
// language", 1994), with fields, without contexts but for results that are one
// of the call's own arguments.
//
// Fields are told apart by class and position, not by object: two objects of
// one class share their fields. Elements of an array are told apart where their
// index is constant; those of a container are one location, however it keeps
// them (see the rules' containers).
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CLASSOBJECTACCESS_H
#define TPC_CLASSOBJECTACCESS_H

#include "calls/SimpleCallGraph.h"
#include "memory/Location.h"
#include "memory/Reaching.h"
#include "support/DebugTypes.h"

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

/// More places than this for one pointer say nothing any more.
inline constexpr unsigned MaxLocations = 64;

/// Classes in classes that are entered. Real ones end long before; classes that
/// are taken for the same because they look alike may contain each other.
inline constexpr unsigned MaxPath = 32;

/// The element of an array, of whatever dimension; else \p T.
llvm::Type *elementOf(llvm::Type *T);

/// Numbers the classes of a module. The same class read from two files can be
/// `class.A` and `class.A.7`: they get one number where they also look alike.
class TypeNumbers {
public:
  unsigned numberOf(llvm::StructType *T);
  llvm::StructType *typeOf(unsigned Number) const { return Types[Number]; }
  /// True for a class of the standard library.
  bool isStandard(unsigned Number) const;

private:
  llvm::DenseMap<llvm::StructType *, unsigned> Numbers;
  llvm::StringMap<llvm::SmallVector<unsigned, 1>> ByName;
  llvm::SmallVector<llvm::StructType *, 0> Types;
};

/// A load, a store, a copy of a whole object, or a call that gets a pointer to
/// it and whose body is not known.
struct Access {
  llvm::Instruction *I;
  Location Where;
};

class AccessResult {
public:
  /// The locations that \p Pointer can point to. With \p Scalar a class is
  /// entered down to the scalar at its beginning: what a load or store of a
  /// scalar touches. Empty where nothing is known.
  Locations resolve(const llvm::Value *Pointer, bool Scalar) const;

  /// What can be reached from \p Pointer by one who is handed it: of an array
  /// all elements, unless \p IsOne says that just an object is meant.
  Locations handed(const llvm::Value *Pointer, bool IsOne) const;

  /// What \p I, a load or store, touches: a scalar, or all scalars of what is
  /// loaded or stored as one value.
  Locations touched(const llvm::Instruction &I) const;
  /// The same with the bits of the register.
  llvm::SmallVector<ScalarPart, 1> partsOf(const llvm::Instruction &I) const;
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

  const TypeNumbers &types() const { return Numbers; }
  DebugTypes &debugTypes() const { return *Debug; }
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
  /// The last step to a location, or its root where there is none.
  using Slot = std::pair<const void *, unsigned>;

  struct Builder;
  /// Numbers by location.
  struct Index {
    llvm::DenseMap<std::pair<Slot, const llvm::Value *>,
                   llvm::SmallVector<unsigned, 2>>
        Exact; ///< of a slot and a root, which may be null
    /// Those with a root that pointers without a known one can lead to.
    llvm::DenseMap<Slot, llvm::SmallVector<unsigned, 2>> Rooted;
  };
  /// Objects by where they are, and by the classes that are in them.
  struct ObjectIndex {
    Index BySlot;
    llvm::DenseMap<unsigned, llvm::SmallVector<unsigned, 4>> ByClass;
  };
  /// Accesses by all objects that they are inside of.
  struct PartIndex {
    Index BySlot;
    llvm::DenseMap<unsigned, llvm::SmallVector<unsigned, 4>> ByClass;
  };

  void findClassesOfGlobals(const llvm::Module &M);
  void addPointees(const llvm::Value *Pointer, Locations &Out) const;
  void addTo(Locations &Out, Location L) const;
  void extend(Location &L, llvm::ArrayRef<Step> Steps) const;
  void moveOn(Location &L, const llvm::Value *Index, llvm::Type *Unit) const;
  bool anyElement(Location &L) const;
  void follow(Location &L, const llvm::GEPOperator &GEP) const;
  void followChain(Location L, llvm::ArrayRef<const llvm::GEPOperator *> Chain,
                   bool Walks, Locations &Out) const;
  Locations copied(const llvm::MemTransferInst &Copy,
                   const llvm::Value *Pointer) const;
  void addAllocated(const Location &L,
                    llvm::ArrayRef<const llvm::GEPOperator *> Chain,
                    Locations &Out) const;
  void enterElement(Location &L) const;
  void enterScalar(Location &L) const;
  void addParts(const Location &L, llvm::Type *T, int64_t At, uint64_t Size,
                llvm::SmallVectorImpl<ScalarPart> &Out) const;
  bool addPartsAround(Location L, uint64_t Size,
                      llvm::SmallVectorImpl<ScalarPart> &Out) const;
  llvm::Type *declaredTypeAt(const Location &L) const;
  llvm::Type *typeAt(const Location &L) const;
  const llvm::DIType *debugTypeAt(const Location &L) const;
  bool isAlike(llvm::Type *A, llvm::Type *B) const;
  bool descend(Location &L, int64_t &Offset, llvm::Type *Until) const;
  void enterField(Location &L, llvm::StructType *T, unsigned Field) const;
  bool mayBe(const Location &A, const Location &B) const;
  bool contains(llvm::Type *Outer, unsigned Inner) const;
  std::optional<llvm::SmallVector<Step, 4>> partOf(const Location &Object,
                                                   const Location &L) const;
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
  static Slot slot(const Location &L);
  static const llvm::Value *baseOf(const llvm::Value *Pointer);
  bool isReachable(const Location &L) const;
  void file(Index &In, unsigned N, const Location &L) const;
  void fileObject(ObjectIndex &In, unsigned N, const Location &Object) const;
  void filePart(PartIndex &In, unsigned N, const Location &L) const;
  template <typename Fn>
  void eachAt(const Location &L, const Index &In, Fn F) const;
  template <typename Fn>
  void eachAround(const Location &L, const Index &In, Fn F) const;

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

  const llvm::DataLayout *Layout = nullptr;
  std::unique_ptr<DebugTypes> Debug;
  /// The locals that code elsewhere can reach without naming them.
  llvm::DenseSet<const llvm::Value *> Escaped;
  /// The locals whose address another function has stored somewhere.
  llvm::DenseSet<const llvm::Value *> KeptElsewhere;
  /// Of globals whose type is another for the sake of their initial value.
  llvm::DenseMap<const llvm::GlobalVariable *, llvm::StructType *>
      ClassOfGlobal;
  mutable TypeNumbers Numbers;
  /// What the pointers that are not computed on the spot can lead to:
  /// arguments, results, merges, and pointers that were in memory.
  llvm::DenseMap<const llvm::Value *, Locations> Targets;
  /// Those of them that lead to nothing else than their targets.
  llvm::DenseSet<const llvm::Value *> Complete;
  llvm::SmallVector<Access, 0> Loads, Stores;
  llvm::SmallVector<Access, 0> Handed; ///< calls without a known body
  llvm::SmallVector<Copy, 0> Copies;
  Index LoadIndex, StoreIndex, HandedIndex;
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

/// Calls \p F with the numbers that \p In has for what can be \p L.
template <typename Fn>
void AccessResult::eachAt(const Location &L, const Index &In, Fn F) const {
  auto Visit = [&](const auto &Map, const auto &Key) {
    if (auto It = Map.find(Key); It != Map.end())
      llvm::for_each(It->second, F);
  };
  Slot Here = slot(L);
  Visit(In.Exact, std::pair(Here, L.Root));
  if (!L.Root)
    Visit(In.Rooted, Here);
  else if (!L.Path.empty() && isReachable(L))
    Visit(In.Exact, std::pair(Here, static_cast<const llvm::Value *>(nullptr)));
}

/// Calls \p F with the numbers that \p In has for \p L and for the objects
/// that its path leads through.
template <typename Fn>
void AccessResult::eachAround(const Location &L, const Index &In, Fn F) const {
  if (L.Root)
    eachAt({L.Root, {}}, In, F);
  for (size_t K = 1; K <= L.Path.size(); ++K)
    eachAt({L.Root,
            llvm::SmallVector<Step, 4>(llvm::ArrayRef(L.Path).take_front(K))},
           In, F);
}

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
