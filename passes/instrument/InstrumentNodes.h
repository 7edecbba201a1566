//===- InstrumentNodes.h - Reports which object is which node -------------===//
//
// A process of ROS 2 may have several nodes, such as the components in one
// container. Behind each call that makes a node, the instrumentation inserts
//
//   void log_node(const char *node, const void *object, unsigned long size)
//
// with what the node's get_fully_qualified_name() returns, and with the object
// that is the node: all bytes of the class whose constructor makes it as a base
// class, if that is known. It does the same for the interface by which the
// parameters of a node are read.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_INSTRUMENTNODES_H
#define TPC_INSTRUMENTNODES_H

#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/DerivedTypes.h"
#include "llvm/IR/Module.h"

#include <string>

namespace tpc {

class Rules;

/// The mangled name of the method of \p Class, such as `ns::Node`, that returns
/// its full name; empty if the class is in no namespace.
std::string nodeNameOf(llvm::StringRef Class);

/// False if \p M has a method \p NodeName that does not return a C string.
bool givesText(const llvm::Module &M, llvm::StringRef NodeName);

/// The function \p Name of type \p T, with a node at \p Node among its
/// arguments. If the program has the method \p NodeName and the log library's
/// \p LogName, it passes all of them on, with what the method returns in place
/// of the node. Made once.
llvm::Function *withNodeName(llvm::Module &M, llvm::StringRef Name,
                             llvm::FunctionType *T, unsigned Node,
                             llvm::StringRef NodeName, llvm::StringRef LogName);

/// Inserts the reports of the nodes that \p M makes, of the classes whose
/// parameters \p Tables describe, and returns what it inserted, in the order of
/// its uses. The calls do nothing in a program without the log library.
llvm::SmallVector<llvm::Instruction *, 0> insertNodes(llvm::Module &M,
                                                      const Rules &Tables);

} // namespace tpc

#endif // TPC_INSTRUMENTNODES_H
