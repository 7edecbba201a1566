//===- MadeObjects.h - The objects that reads of parameters make ----------===//
//
// A read may make an object, such as an rclcpp::Parameter. Which read the
// object at some place of the program comes from is decided by the last
// assignment of a local variable, or by where the object is stored.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_MADEOBJECTS_H
#define TPC_MADEOBJECTS_H

#include "memory/PointsTo.h"
#include "params/ParamCallFinder.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/ADT/SmallPtrSet.h"

namespace tpc {

/// True if \p Call, of \p Callee, does not assign to its argument \p Object.
bool leavesUnchanged(const llvm::CallBase &Call, const llvm::Function &Callee,
                     const llvm::Value *Object);

/// The object that accessors have taken \p Object out of: an accessor can
/// return an object that has accessors too. Null if that is not known.
const llvm::Value *objectBehind(const llvm::Value *Object,
                                const RuleMatches &Rules);

class MadeObjects {
public:
  /// Those of \p Reads, which may grow.
  MadeObjects(const std::vector<ParameterRead> &Reads, const RuleMatches &Rules,
              PointsTo &Pointers)
      : Reads(Reads), Rules(Rules), Pointers(Pointers) {}

  /// \p Made is an object of the read \p Read.
  void add(unsigned Read, llvm::Value *Made);

  /// The numbers of the reads that \p Object, which \p At uses, comes from.
  llvm::SmallVector<unsigned, 2> readsOf(const llvm::Value *Object,
                                         const llvm::Instruction &At);

private:
  /// An object: the pointers to it, and where it is stored.
  struct MadeObject {
    unsigned Read;
    const llvm::Value *Made; ///< the object itself
    llvm::SmallPtrSet<const llvm::Value *, 2> Pointers;
    Locations Where;
  };
  /// Reads by number; none if it is not known.
  using Numbers = std::optional<llvm::SmallSetVector<unsigned, 2>>;

  Numbers lastAssigned(const llvm::Value *Local, const llvm::Instruction &At,
                       unsigned Depth = 0);
  std::optional<bool> ends(const llvm::CallBase &Call, const llvm::Value *Local,
                           unsigned Depth,
                           llvm::SmallSetVector<unsigned, 2> &Found);
  bool addReturned(const llvm::Function &F,
                   llvm::SmallSetVector<unsigned, 2> &Out) const;
  llvm::SmallVector<unsigned, 2> storedAt(const llvm::Value *Object);

  const std::vector<ParameterRead> &Reads;
  const RuleMatches &Rules;
  PointsTo &Pointers;
  llvm::SmallVector<MadeObject, 0> Objects;
};

} // namespace tpc

#endif // TPC_MADEOBJECTS_H
