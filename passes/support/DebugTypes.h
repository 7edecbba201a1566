//===- DebugTypes.h - The source's classes, from debug information --------===//
//
// When files are linked, LLVM merges classes that look alike into one type: any
// pair of doubles has the same type. The debug information still has the
// classes of the source. This finds the one that a pointer leads to.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_DEBUGTYPES_H
#define TPC_DEBUGTYPES_H

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/StringMap.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/DerivedTypes.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Operator.h"
#include "llvm/IR/PassManager.h"

#include <optional>

namespace tpc {

class DebugTypes {
public:
  explicit DebugTypes(const llvm::DataLayout &Layout) : Layout(Layout) {}

  /// \p T without typedefs and qualifiers.
  static const llvm::DIType *plain(const llvm::DIType *T);
  /// The type that a pointer or reference of type \p T leads to; null for other
  /// types.
  static const llvm::DIType *dereferenced(const llvm::DIType *T);

  /// The type of \p Arg as it is written, with its qualifiers, or of the result
  /// that it is the place of; null if it is not known.
  static const llvm::DIType *declared(const llvm::Argument &Arg);

  /// The type of the object that \p Pointer points to; null if it is not known.
  const llvm::DIType *pointee(const llvm::Value *Pointer);

  /// \p T, or the base class at its beginning, whichever LLVM lays out as
  /// \p Struct; null if neither is.
  const llvm::DICompositeType *asStruct(const llvm::DIType *T,
                                        llvm::StructType *Struct);

  /// The class of \p All, the types of a module, that \p Global is an object
  /// of; null if there is none.
  llvm::StructType *classOf(const llvm::GlobalVariable &Global,
                            llvm::ArrayRef<llvm::StructType *> All);

  /// The type of field \p Index of \p Class, which has the layout \p Struct.
  const llvm::DIType *field(const llvm::DICompositeType *Class,
                            llvm::StructType *Struct, unsigned Index) const;
  /// True if that field is const.
  bool isConst(const llvm::DICompositeType *Class, llvm::StructType *Struct,
               unsigned Index) const;
  /// The name of that field; empty for a base class.
  llvm::StringRef fieldName(const llvm::DICompositeType *Class,
                            llvm::StructType *Struct, unsigned Index) const;

  /// The mangled name of \p Class, which is the same in all files: `_ZTS4Node`.
  /// Empty if it has none, as in an unnamed namespace.
  static std::string identifierOf(const llvm::DICompositeType &Class);
  /// A number for \p Class, the same in all files; 0 for null.
  unsigned numberOf(const llvm::DICompositeType *Class);
  const llvm::DICompositeType *classOf(unsigned Number) const {
    return Number ? Classes[Number - 1] : nullptr;
  }

  /// False if no object of type \p T is one of the class number \p Inner or
  /// contains one. True if the debug information does not tell.
  bool mayContain(const llvm::DIType *T, unsigned Inner);

private:
  const llvm::DIType *firstScalar(const llvm::DIType *T) const;
  const llvm::DIType *find(const llvm::Value *Pointer);
  const llvm::DIType *ofTemporary(const llvm::AllocaInst &Local);
  const llvm::DIType *ofArgument(const llvm::Argument &Arg) const;
  const llvm::DIType *ofElement(const llvm::GEPOperator &GEP);
  const llvm::DICompositeType *findStruct(const llvm::DIType *T,
                                          llvm::StructType *Struct) const;
  const llvm::DIDerivedType *memberAt(const llvm::DICompositeType *Class,
                                      uint64_t Bits) const;

  const llvm::DataLayout &Layout;
  llvm::DenseMap<const llvm::Value *, const llvm::DIType *> Known;
  /// Cached results of asStruct.
  llvm::DenseMap<std::pair<const llvm::DIType *, llvm::StructType *>,
                 const llvm::DICompositeType *>
      Structs;
  /// Cached results of mayContain.
  llvm::DenseMap<std::pair<const llvm::DIType *, unsigned>, bool> Contained;
  llvm::DenseMap<const llvm::DICompositeType *, unsigned> Numbers;
  llvm::StringMap<unsigned> ByName;
  llvm::SmallVector<const llvm::DICompositeType *, 0> Classes;
};

/// Where an object of the class \p T has its pointer to a message that it has
/// borrowed from a publisher, in bytes; none if it has none.
std::optional<uint64_t> borrowedAt(const llvm::DIType *T);

/// True for std::shared_ptr, boost::shared_ptr and std::unique_ptr.
bool isSmartPointer(const llvm::DIType *T);
/// T of the class template A<T, ...> that \p Class is made of; null if it is
/// not made of one.
const llvm::DIType *firstArgumentOf(const llvm::DICompositeType &Class);
/// The virtual function, other than the destructor, that \p Class itself
/// declares in \p Slot of its table; null if none is known.
const llvm::DISubprogram *virtualIn(const llvm::DICompositeType &Class,
                                    unsigned Slot);
/// True for a smart pointer through which nothing can be written.
bool pointsToConst(const llvm::DIType *T);

class DebugTypesAnalysis : public llvm::AnalysisInfoMixin<DebugTypesAnalysis> {
public:
  using Result = DebugTypes;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<DebugTypesAnalysis>;
  static llvm::AnalysisKey Key;
};

} // namespace tpc

#endif // TPC_DEBUGTYPES_H
