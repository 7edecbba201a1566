//===- InstrumentReads.h - Reports the names of parameters ----------------===//
//
// Only the running node knows the full name of a parameter whose handle or name
// is put together at run time. Before such a read, the instrumentation inserts
//
//   void log_read(char *key, const void *handle, const void *name, bool text)
//
// with the key of the read, the ros::NodeHandle (null for ros::param), and the
// name: a std::string, or with `text` a C string. The log library resolves the
// name as roscpp does. In a method it calls log_read_of instead, if the library
// has it, with the object and its size as well: two objects may read different
// parameters there.
//
// For a node of rclcpp, which resolves no names, it calls
//
//   void log_read_in(char *key, const char *node, const void *name, bool text,
//                    const void *object, unsigned long size)
//
// with what the node's get_fully_qualified_name() returns.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_INSTRUMENTREADS_H
#define TPC_INSTRUMENTREADS_H

#include "instrument/Prepare.h"
#include "params/ParamCallFinder.h"

#include "llvm/IR/InstrTypes.h"

#include <optional>

namespace tpc {

/// A name to report, in terms of the instrumented program.
struct NamedRead {
  std::string Key;
  llvm::CallBase *Before;
  llvm::Value *Handle; ///< null for none
  uint64_t HandleOffset = 0;
  llvm::Value *Name; ///< null: the name is Text
  std::string Text;
  bool IsText; ///< Name, if there is one, is a C string and no std::string
  llvm::Value *Object = nullptr; ///< which the call is in a method of
  uint64_t ObjectSize = 0;       ///< in bytes
  /// The mangled name of the method of Handle, a node of rclcpp, that returns
  /// its name; empty for other handles.
  std::string NodeName = {};
};

/// The report of the name of \p Read; none if roscpp does not resolve it, or if
/// the call has no counterpart in the original program.
std::optional<NamedRead> planName(const ParameterRead &Read,
                                  const AnalysedModule &Analysed);

/// Inserts \p Reads, and returns what it inserted, in the order of its uses.
/// The calls do nothing in a program without the log library.
llvm::SmallVector<llvm::Instruction *, 0>
insertNames(llvm::Module &M, llvm::ArrayRef<NamedRead> Reads);

} // namespace tpc

#endif // TPC_INSTRUMENTREADS_H
