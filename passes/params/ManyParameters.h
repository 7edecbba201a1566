//===- ManyParameters.h - Calls that read several parameters --------------===//
//
// rclcpp reads a list of names into a list of objects, and all parameters below
// a prefix into a map (`many` in rules/*.json). Each parameter is a read of its
// own: by the place of its name in the list, or by the key with which the
// program looks it up in the map.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_MANYPARAMETERS_H
#define TPC_MANYPARAMETERS_H

#include "memory/VisibleWrites.h"
#include "params/ParamCallFinder.h"

namespace tpc {

class Texts;

/// The place in its list of the element that \p Element, a pointer to it, was
/// taken from by a constant index; none if it is not known.
std::optional<unsigned> indexOf(const llvm::Value *Element);

class ManyParameters {
public:
  /// Adds to \p Reads; \p Known finds the names.
  ManyParameters(llvm::Module &M, llvm::ModuleAnalysisManager &AM, Texts &Known,
                 std::vector<ParameterRead> &Reads);

  /// Adds the reads of \p Call, described by \p Row, which reads several
  /// parameters.
  void add(llvm::CallBase &Call, const Rule &Row);

private:
  /// A call that returns a pointer to an element of a container, or an
  /// iterator.
  struct Access {
    llvm::CallBase *Call;
    Locations Map;          ///< the container
    const llvm::Value *Key; ///< null if it is not looked up by a key
    bool IsMoved = false;   ///< an iterator that may be moved on
  };

  void addList(llvm::CallBase &Call, const Rule &Row);
  void addMap(llvm::CallBase &Call, const Rule &Row);
  /// The texts that \p List, a std::vector, was made of where it was written in
  /// braces; none if it was not, or may be changed.
  std::vector<std::string> textsIn(const llvm::Value *List);
  llvm::ArrayRef<Access> accesses();

  llvm::Module &M;
  const RuleMatches &Rules;
  PointsTo &Pointers;
  VisibleWrites &Writes;
  Texts &Known;
  std::vector<ParameterRead> &Reads;
  std::optional<std::vector<Access>> Accesses; ///< collected once, if needed
};

} // namespace tpc

#endif // TPC_MANYPARAMETERS_H
