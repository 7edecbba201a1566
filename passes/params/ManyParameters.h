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

#include "params/ParamCallFinder.h"

namespace tpc {

class Texts;

/// The place in its list of the element that \p Element, a pointer to it, was
/// taken from by a constant index; none if it is not known.
std::optional<unsigned> indexOf(const llvm::Value *Element);

/// Adds to \p Reads those of \p Call, described by \p Row, which reads several
/// parameters; \p Known finds their names.
void addMany(llvm::CallBase &Call, const Rule &Row,
             llvm::ModuleAnalysisManager &AM, Texts &Known,
             std::vector<ParameterRead> &Reads);

} // namespace tpc

#endif // TPC_MANYPARAMETERS_H
