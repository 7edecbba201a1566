//===- TextUsage.h - Where a string is compared ---------------------------===//
//
// The inside of a std::string is never analysed. The rules name the calls that
// use one (`text` in rules/*.json): comparisons, and copies, which give another
// object the same text. The same holds for an object that holds one number,
// such as a ros::Duration: `held`. For lists and structs the rules name the
// methods that say something about one, such as its size: `properties`.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_TEXTUSAGE_H
#define TPC_TEXTUSAGE_H

#include "Rules.h"
#include "memory/VisibleWrites.h"

namespace tpc {

struct TextComparison {
  llvm::Instruction *Outcome; ///< a truth value
  llvm::StringRef Relation;
  const llvm::Value *Text; ///< the pointer to the string
};

class TextUsage {
public:
  TextUsage(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

  struct Found {
    llvm::SmallVector<TextComparison, 4> Comparisons;
    unsigned Lost = 0; ///< comparisons whose result is used in other ways
  };
  /// The comparisons of the strings at \p Objects, or of copies of them. With
  /// \p IsList, they are elements, which copies of the list take with them.
  Found comparisonsOf(Locations Objects, bool IsList) const;

  /// The calls that take the number out of the object again into which \p Into,
  /// a call that a row of `held` describes, puts it, or out of a copy.
  llvm::SmallVector<llvm::CallBase *, 2> numbersFrom(const llvm::CallBase &Into,
                                                     const Rule &Row) const;

  /// A call that says something about a list or struct.
  struct Property {
    llvm::CallBase *Call;
    const Rule *Row;
    Locations Elements; ///< of the list
  };
  /// Those about the list with the elements \p Elements, about copies of it, or
  /// about a list that is one of its elements.
  llvm::SmallVector<const Property *, 2>
  propertiesOf(const Locations &Elements) const;

private:
  /// A pointer that a call passes on, and the steps that the functions which it
  /// enters take from there, the last one first.
  struct Passed {
    const llvm::Value *Pointer;
    llvm::SmallVector<const llvm::GEPOperator *, 4> Steps = {};
  };
  /// The objects between which a text is copied, in one of the calls by which
  /// the copy runs.
  struct Copy {
    Locations To, From;
  };
  struct Use {
    llvm::CallBase *Call;
    const Rule *Row;
    llvm::SmallVector<Locations, 2> Operands; ///< of its first two
  };
  bool addCopies(const llvm::Function &F, const Passed &To, const Passed &From,
                 unsigned Depth, llvm::SmallVectorImpl<Copy> &Out);
  Locations objectsAt(const Passed &P) const;
  /// True if copies of whole objects can bring one of \p From to one of \p To.
  bool anyReaches(const Locations &From, const Locations &To) const;

  const CallGraphResult &Calls;
  LocationTypes &Types;
  PointsTo &Pointers;
  AccessIndex &Accesses;
  std::vector<Copy> Copies;
  std::vector<Use> Uses;
  std::vector<std::pair<llvm::CallBase *, Locations>> Numbers;
  std::vector<Property> Properties;
};

/// True if \p Type, the type of a parameter, is text.
bool isText(llvm::StringRef Type);

} // namespace tpc

#endif // TPC_TEXTUSAGE_H
