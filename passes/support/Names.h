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
/// template arguments: `ros::NodeHandle::param`. Returns a name that is not
/// mangled unchanged.
std::string qualifiedName(llvm::StringRef Mangled);

/// `void f(int)` for \p F, for people and for keys.
std::string functionName(const llvm::Function &F);

/// `ns::Class::f` for the function that contains \p Loc; the same for all
/// instances of a template and after inlining.
std::string functionNameFor(const llvm::DILocation &Loc);

/// The parameter types of \p F as written, from its demangled name.
llvm::SmallVector<std::string, 4> parameterTypes(const llvm::Function &F);

/// \p Type, as parameterTypes returns it, without const, & and template
/// arguments; a string is always `std::string`.
std::string plainType(llvm::StringRef Type);

/// The first template argument of the class of the method \p F; empty if there
/// is none.
std::string classArgument(const llvm::Function &F);

/// The type of \p F's result: from its mangled name (only templates have it
/// there), otherwise from the code; empty for an object.
std::string resultType(const llvm::Function &F);

/// True for the mangled names of the functions that free memory.
bool givesMemoryBack(llvm::StringRef Mangled);

/// True if \p Call calls a function without a body that ends the life of its
/// argument: nobody reads what it writes there.
bool endsLife(const llvm::CallBase &Call);

/// `ns::Node` for the type `class.ns::Node.7`: without the kind, and without
/// the suffix that distinguishes copies of one class.
llvm::StringRef plainClassName(const llvm::StructType &T);

} // namespace tpc

#endif // TPC_NAMES_H
