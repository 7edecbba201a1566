//===- LocationTypes.h - What a location is of ----------------------------===//
//
// The type that LLVM gives what stands at a location, the class that the source
// gives it, and the ways from one location to others: into a class, along an
// array, so many bytes on. Nothing here knows of pointers.
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

/// Classes in classes that are entered. Real ones end long before; classes that
/// are taken for the same because they look alike may contain each other.
inline constexpr unsigned MaxPath = 32;

/// The element of an array, of whatever dimension; else \p T.
llvm::Type *elementOf(llvm::Type *T);

/// Classes are numbered, and their debug information is looked for, when they
/// are first met: most of the members are not const for that.
class LocationTypes {
public:
  LocationTypes(const llvm::Module &M, DebugTypes &Debug);

  /// The type that the variable at \p L was declared with, also where \p L is
  /// one element of it; null where it is not known.
  llvm::Type *declaredTypeAt(const Location &L) const;
  /// The type of what is at \p L.
  llvm::Type *typeAt(const Location &L) const;

  /// The class that \p S, a step to a field, leads into.
  llvm::StructType *classOf(const Step &S) const {
    return Numbers.typeOf(S.Type);
  }
  /// The same as the source has it; null where that is not known.
  const llvm::DICompositeType *sourceClassOf(const Step &S) const {
    return Debug.classOf(S.Class);
  }
  /// The name of the field that \p S leads to; empty where it has none.
  llvm::StringRef fieldName(const Step &S) const;
  /// True where that field is const.
  bool isConst(const Step &S) const;
  /// The type that the source gives it; null where that is not known.
  const llvm::DIType *sourceTypeOf(const Step &S) const;

  /// True for one type, and for one class that was read from two files.
  bool isAlike(llvm::Type *A, llvm::Type *B);
  /// Adds the numbers of the classes that are in an object of type \p T.
  void addClassesIn(llvm::Type *T, llvm::SmallSetVector<unsigned, 8> &Out);
  /// True where the class \p Inner is \p Outer, or in it.
  bool contains(llvm::Type *Outer, unsigned Inner);

  /// Of an array the element at its beginning.
  void enterElement(Location &L) const;
  /// The scalar at the beginning.
  void enterScalar(Location &L);
  /// Goes the way of \p GEP from \p L.
  void follow(Location &L, const llvm::GEPOperator &GEP);
  /// Goes \p Steps further from \p L. How a container keeps its elements, in
  /// nodes or in pairs with a key, makes no difference: those steps are left
  /// out.
  void extend(Location &L, llvm::ArrayRef<Step> Steps) const;
  /// Goes \p Offset bytes into \p L, and with \p Until no further than to an
  /// object of that class, or an element of that type in an array; takes the
  /// way off \p Offset. False where nothing begins there.
  bool descend(Location &L, int64_t &Offset, llvm::Type *Until);
  /// Makes of a place in an array of scalars any place there; false elsewhere.
  bool anyElement(Location &L) const;

  /// Adds the scalars that an access of \p Size bytes touches which begins with
  /// the scalar at \p L: those that follow it are in one of the objects that it
  /// is in. False where it is no more than that scalar.
  bool addScalars(Location L, uint64_t Size,
                  llvm::SmallVectorImpl<ScalarPart> &Out);

  /// Prints \p L for the dumps of the analyses: `@Global[struct.Outer.0][any]`.
  void print(llvm::raw_ostream &OS, const Location &L) const;

private:
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
  /// Of globals whose type is another for the sake of their initial value.
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
