//===- TextUsage.h - Where a string is compared ---------------------------===//
//
// A std::string is an object that is never looked into. What is done with one
// are calls that the tables name (`text` in rules/*.json): comparisons, and
// copies, which make another object the same text. Likewise an object that
// holds one number, a ros::Duration: `held`.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_TEXTUSAGE_H
#define TPC_TEXTUSAGE_H

#include "Rules.h"
#include "memory/PointsTo.h"

namespace tpc {

struct TextComparison {
  llvm::Instruction *Outcome; ///< a truth value
  llvm::StringRef Relation;
  bool ByArgument; ///< the string came by an argument of the function
};

class TextUsage {
public:
  TextUsage(llvm::Module &M, PointsTo &Pointers, const RuleMatches &Rules);

  struct Found {
    llvm::SmallVector<TextComparison, 4> Comparisons;
    unsigned Lost = 0; ///< comparisons whose result is used otherwise
  };
  /// The comparisons of what is in the string at \p Object, or copied from it.
  Found comparisonsOf(const llvm::Value *Object) const;

  /// The calls that take the number out again that \p Into, a call that a row
  /// of `held` describes, puts into an object.
  llvm::SmallVector<llvm::CallBase *, 2> numbersFrom(const llvm::CallBase &Into,
                                                     const Rule &Row) const;

private:
  struct Use {
    llvm::CallBase *Call;
    const Rule *Row;
    llvm::SmallVector<Locations, 2> Operands; ///< of its first two
  };
  PointsTo &Pointers;
  std::vector<Use> Uses;
  std::vector<std::pair<llvm::CallBase *, Locations>> Numbers;
};

/// True for the type of a parameter that is text.
bool isText(llvm::StringRef Type);

} // namespace tpc

#endif // TPC_TEXTUSAGE_H
