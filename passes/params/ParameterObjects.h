//===- ParameterObjects.h - Parameters that come in objects ---------------===//
//
// Two ways in which a value is not in a variable at once: a read gives an
// object of which a method gives the value (rclcpp::Parameter::as_double), and
// a class of which each field is a parameter comes into a callback
// (dynamic_reconfigure). Which, the tables say.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_PARAMETEROBJECTS_H
#define TPC_PARAMETEROBJECTS_H

#include "params/ParamCallFinder.h"

namespace tpc {

/// Gives each read of \p Reads that makes an object the values that are taken
/// out of it. What is taken out of an object that no read made becomes a read
/// of its own, whose name is not known.
void findAccessors(llvm::Module &M, llvm::ModuleAnalysisManager &AM,
                   std::vector<ParameterRead> &Reads);

/// Adds to \p Reads the fields of the classes that are handed to callbacks, as
/// far as the user's code reads them.
void findConfigs(llvm::Module &M, llvm::ModuleAnalysisManager &AM,
                 std::vector<ParameterRead> &Reads);

} // namespace tpc

#endif // TPC_PARAMETEROBJECTS_H
