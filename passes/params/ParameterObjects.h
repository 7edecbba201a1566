//===- ParameterObjects.h - Parameters inside of objects ------------------===//
//
// Two APIs do not put the value into a variable directly: a read may return an
// object with a method that returns the value (rclcpp::Parameter::as_double),
// and a callback may get a class whose fields are all parameters
// (dynamic_reconfigure). The rules list both.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_PARAMETEROBJECTS_H
#define TPC_PARAMETEROBJECTS_H

#include "params/ParamCallFinder.h"

namespace tpc {

class Texts;

/// The name of \p Class with its scopes.
std::string nameWithScopes(const llvm::DICompositeType &Class);

/// What \p Call, a method of an object that a read made, returns: its result,
/// or the loads through the reference that it returns.
llvm::SmallVector<llvm::Value *, 1> valuesOf(llvm::CallBase &Call);

/// The type of the value that \p F, which \p Row of kind Accessor describes,
/// takes out of an object.
std::string accessedType(const llvm::Function &F, const Rule &Row);

/// True for the types, as accessedType returns them, of texts and of lists:
/// their values are objects.
bool isObjectType(llvm::StringRef Type, const RuleMatches &Rules);

/// Adds to each read of \p Reads that makes an object the values that are taken
/// out of it. A value taken out of an object that no read made becomes a read
/// of its own, with an unknown name.
void findAccessors(llvm::Module &M, llvm::ModuleAnalysisManager &AM,
                   Texts &Known, std::vector<ParameterRead> &Reads);

/// Adds to \p Reads the fields of the classes that callbacks get, if user code
/// reads them; \p Known finds the namespace of the server.
void findConfigs(llvm::Module &M, llvm::ModuleAnalysisManager &AM, Texts &Known,
                 std::vector<ParameterRead> &Reads);

} // namespace tpc

#endif // TPC_PARAMETEROBJECTS_H
