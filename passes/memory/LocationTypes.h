//===- LocationTypes.h - The types of locations ---------------------------===//
//
// LLVM's type of the object at a location, its class in the source, and how to
// get from one location to another: into a class, along an array, by a number
// of bytes. Nothing here knows about pointers.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LOCATIONTYPES_H
#define TPC_LOCATIONTYPES_H

#include "memory/Location.h"
#include "memory/TypeNumbers.h"
#include "support/DebugTypes.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/IR/PassManager.h"

namespace tpc {

/// The nesting of classes that is followed. Real classes are never nested as
/// deeply; classes that count as the same because they look alike may contain
/// each other.
inline constexpr unsigned MaxPath = 32;

/// The element type of an array of any dimension; otherwise \p T.
llvm::Type *elementOf(llvm::Type *T);

/// Classes are numbered, and their debug information is searched, when they are
/// first met; most members are therefore not const.
class LocationTypes {
public:
  LocationTypes(const llvm::Module &M, DebugTypes &Debug);

  /// The declared type of the variable at \p L, also if \p L is one of its
  /// elements; null if it is not known.
  llvm::Type *declaredTypeAt(const Location &L) const;
  /// The type of the object at \p L.
  llvm::Type *typeAt(const Location &L) const;

  /// The class that \p S, a step to a field, leads into.
  llvm::StructType *classOf(const Step &S) const {
    return Numbers.typeOf(S.Type);
  }
  /// The same class in the source; null if it is not known.
  const llvm::DICompositeType *sourceClassOf(const Step &S) const {
    return Debug.classOf(S.Class);
  }
  /// The name of the field that \p S leads to; empty if it has none.
  llvm::StringRef fieldName(const Step &S) const;
  /// True if that field is const.
  bool isConst(const Step &S) const;
  /// The type of that field in the source; null if it is not known.
  const llvm::DIType *sourceTypeOf(const Step &S) const;

  /// True for the same type, and for one class that was read from two files.
  bool isAlike(llvm::Type *A, llvm::Type *B);
  /// Adds the numbers of the classes in an object of type \p T.
  void addClassesIn(llvm::Type *T, llvm::SmallSetVector<unsigned, 8> &Out);
  /// True if the class that \p Inner leads into can be that of the object at
  /// \p Outer, or of a part of it.
  bool contains(const Location &Outer, const Step &Inner);

  /// Moves \p L from an array to its first element.
  void enterElement(Location &L) const;
  /// Moves \p L to the scalar at its beginning.
  void enterScalar(Location &L);
  /// Moves \p L as \p GEP does.
  void follow(Location &L, const llvm::GEPOperator &GEP);
  /// Appends \p Steps to \p L. Steps into the nodes or pairs in which a
  /// container keeps its elements are left out.
  void extend(Location &L, llvm::ArrayRef<Step> Steps) const;
  /// Moves \p L into the part at \p Offset bytes and reduces \p Offset
  /// accordingly. With \p Until, stops at an object of that class or an array
  /// element of that type. False if nothing begins there.
  bool descend(Location &L, int64_t &Offset, llvm::Type *Until);
  /// Turns an element of an array of scalars into any element; false for other
  /// places.
  bool anyElement(Location &L) const;

  /// Adds the scalars touched by an access of \p Size bytes that begins with
  /// the scalar at \p L. Those that follow are in one of the objects that
  /// contain it. False if only that scalar is touched.
  bool addScalars(Location L, uint64_t Size,
                  llvm::SmallVectorImpl<ScalarPart> &Out);

  /// Prints \p L as the printers show it: `@Global[struct.Outer.0][any]`.
  void print(llvm::raw_ostream &OS, const Location &L) const;

private:
  bool contains(llvm::Type *Outer, unsigned Inner);
  void findClassesOfGlobals(const llvm::Module &M);
  const llvm::DIType *debugTypeAt(const Location &L) const;
  void enterField(Location &L, llvm::StructType *T, unsigned Field);
  void moveOn(Location &L, const llvm::Value *Index, llvm::Type *Unit) const;
  void addScalarsOf(const Location &L, llvm::Type *T, int64_t At, uint64_t Size,
                    llvm::SmallVectorImpl<ScalarPart> &Out);

  const llvm::DataLayout &Layout;
  DebugTypes &Debug;
  TypeNumbers Numbers;
  llvm::DenseMap<std::pair<llvm::StructType *, unsigned>, bool> Contained;
  /// For globals whose type differs only because of their initial value.
  llvm::DenseMap<const llvm::GlobalVariable *, llvm::StructType *>
      ClassOfGlobal;
};

class LocationTypesAnalysis
    : public llvm::AnalysisInfoMixin<LocationTypesAnalysis> {
public:
  using Result = LocationTypes;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<LocationTypesAnalysis>;
  static llvm::AnalysisKey Key;
};

} // namespace tpc

#endif // TPC_LOCATIONTYPES_H
