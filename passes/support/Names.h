//===- Names.h - Names of functions, variables and constant strings -------===//
#ifndef TPC_NAMES_H
#define TPC_NAMES_H

#include "llvm/ADT/StringRef.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/DerivedTypes.h"
#include "llvm/IR/Function.h"

#include <string>

namespace tpc {

/// The demangled name of \p Mangled with its scopes, without parameters and
/// without template arguments: `ros::NodeHandle::param`. A name that is not
/// mangled comes back as it is.
std::string qualifiedName(llvm::StringRef Mangled);

/// `void f(int)` of \p F, for people and for keys.
std::string functionName(const llvm::Function &F);

/// `ns::Class::f` of the function that \p Loc is in, the same for all instances
/// of a template and wherever it was inlined.
std::string functionNameFor(const llvm::DILocation &Loc);

/// The written parameters of \p F, from its demangled name.
llvm::SmallVector<std::string, 4> parameterTypes(const llvm::Function &F);

/// \p Type, as parameterTypes gives it, without const, & and template
/// arguments; `std::string` under that name.
std::string plainType(llvm::StringRef Type);

/// The first template argument of the class whose method \p F is; empty where
/// there is none.
std::string classArgument(const llvm::Function &F);

/// The type of \p F's result: that of its name, which only templates have
/// there, else what the code tells; empty for an object.
std::string resultType(const llvm::Function &F);

/// True for the mangled names of the functions that give memory back.
bool givesMemoryBack(llvm::StringRef Mangled);

/// True where \p Call calls a function without a body that ends the life of the
/// object that it is handed: whatever it writes there, nobody reads it.
bool endsLife(const llvm::CallBase &Call);

/// `ns::Node` for the type `class.ns::Node.7`: without the kind, and without
/// what only tells two copies of one class apart.
llvm::StringRef plainClassName(const llvm::StructType &T);

} // namespace tpc

#endif // TPC_NAMES_H
