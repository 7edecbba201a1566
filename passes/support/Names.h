//===- Names.h - Names of functions, variables and constant strings -------===//
#ifndef TPC_NAMES_H
#define TPC_NAMES_H

#include "llvm/ADT/SmallBitVector.h"
#include "llvm/ADT/StringRef.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/DerivedTypes.h"
#include "llvm/IR/Function.h"

#include <string>

namespace tpc {

/// Between the name of a function and the number of a copy of it that serves
/// one call.
inline constexpr llvm::StringLiteral CopyMark = ".tpc.";

/// The mangled name of \p F, or of the function that it is a copy of.
llvm::StringRef nameOfOriginal(const llvm::Function &F);

/// The mangled name of \p F in the source: a copy of a function has a name of
/// its own in the code.
llvm::StringRef linkageName(const llvm::Function &F);

/// The demangled name of \p Mangled with its scopes, without parameters and
/// template arguments: `ros::NodeHandle::param`. Returns a name that is not
/// mangled unchanged.
std::string qualifiedName(llvm::StringRef Mangled);

/// `ns::Node` for `N2ns4NodeE`, the mangled name of a class.
std::string className(llvm::StringRef Mangled);

/// \p Name without scopes.
llvm::StringRef unscoped(llvm::StringRef Name);

/// `ns::Class`, the qualified name of the class or namespace that \p F is in.
std::string scopeOf(const llvm::Function &F);

/// `above()`: without scopes and parameters, for people.
std::string shortName(const llvm::Function &F);

/// The same for the function that \p Call calls.
std::string calleeName(const llvm::CallBase &Call);

/// `void f(int)` for \p F, for people and for keys.
std::string functionName(const llvm::Function &F);

/// `ns::Class::f` for the function that contains \p Loc; the same for all
/// instances of a template and after inlining.
std::string functionNameFor(const llvm::DILocation &Loc);

/// The parameter types of a function as written, from its mangled name.
llvm::SmallVector<std::string, 4> parameterTypes(llvm::StringRef Mangled);
llvm::SmallVector<std::string, 4> parameterTypes(const llvm::Function &F);

/// \p Type, as parameterTypes returns it, without const, & and template
/// arguments; a string is always `std::string`.
std::string plainType(llvm::StringRef Type);

/// The first template argument of the class of the method \p F; empty if there
/// is none.
std::string classArgument(const llvm::Function &F);

/// The first template argument of the function template that \p F is made of;
/// empty if it is not made of one.
std::string functionArgument(const llvm::Function &F);

/// The type of \p F's result: from its mangled name (only templates have it
/// there), otherwise from the code; empty for an object.
std::string resultType(const llvm::Function &F);

/// True if \p Type, as parameterTypes returns it, is `T const &` or `T const
/// *`; what pointers inside of T lead to may change, so not for classes of
/// pointers.
bool takesConst(llvm::StringRef Type);

/// The arguments that \p F, by the types in its mangled name, leaves unchanged:
/// those that it takes as `T const &` or `T const *`. What pointers inside of
/// them lead to may change, so that classes of pointers are left out, and all
/// where the name does not tell which argument is which.
llvm::SmallBitVector constArguments(const llvm::Function &F);

/// The functions of the analysed copy that take the number out of an object and
/// put it into one (see HeldNumbers.h): `double tpc::Held::take() const` and
/// `void tpc::Held::put(double)`.
inline constexpr llvm::StringLiteral TakeName = "_ZNK3tpc4Held4takeEv";
inline constexpr llvm::StringLiteral PutName = "_ZN3tpc4Held3putEd";

/// Metadata of a call in the analysed copy: the result points to an object that
/// nothing else leads to.
inline constexpr llvm::StringLiteral OwnObjectName = "tpc.object";

/// `this` of \p F; null if it has none, as in a static method, or if nothing is
/// known about it.
const llvm::Argument *thisOf(const llvm::Function &F);

/// True for the mangled names of the functions that free memory.
bool givesMemoryBack(llvm::StringRef Mangled);

/// True if the name of \p F, without its scopes, says that the thread waits in
/// it: for a time, for another thread, or for callbacks that it runs.
bool waitsByName(const llvm::Function &F);

/// True for the mangled names of destructors.
bool isDestructor(llvm::StringRef Mangled);

/// True if \p Call calls a function without a body that ends the life of its
/// argument: nobody reads what it writes there.
bool endsLife(const llvm::CallBase &Call);

/// The UUID of version 5 (RFC 4122) for \p Name, in TPC's own namespace.
std::string uuidOf(llvm::StringRef Name);

/// `ns::Node` for the type `class.ns::Node.7`: without the kind, and without
/// the suffix that distinguishes copies of one class.
llvm::StringRef plainClassName(const llvm::StructType &T);

/// True for the class of a ROS message, which its generator makes a template
/// over the allocator: `Pose_<std::allocator<void>>`.
bool isMessageClass(const llvm::DICompositeType &Class);

} // namespace tpc

#endif // TPC_NAMES_H
