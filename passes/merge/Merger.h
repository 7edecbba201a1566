//===- Merger.h - Makes one module of the link units of a process ---------===//
//
// A process is an executable with the libraries and plugins that it loads.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_MERGER_H
#define TPC_MERGER_H

#include "llvm/ADT/StringMap.h"
#include "llvm/IR/LLVMContext.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/MemoryBuffer.h"

#include <memory>
#include <string>
#include <vector>

namespace tpc {

/// A link unit: its files in the order of its linker.
struct UnitFiles {
  struct File {
    std::string Path;
    bool Whole = false; ///< all members of an archive, also those not needed
    bool Lazy = false;  ///< only if needed, as a member of an archive
  };
  std::string Name;
  std::vector<File> Files;
};

/// A file, or a member of an archive, that is not in the module.
struct LeftOut {
  std::string Unit, File, Why;
};

class Merger {
public:
  Merger();
  ~Merger();

  /// Adds the code of the next unit in the order of the dynamic linker.
  void add(const UnitFiles &Unit);

  /// Makes one module of all units; \p Scopes as in Symbols.
  void join(llvm::ArrayRef<std::vector<std::string>> Scopes);

  /// Lets the factories of these plugins make nothing: a library registers all
  /// of its plugins, also those that the process never loads.
  void withoutPlugins(llvm::ArrayRef<std::string> Classes);

  /// Removes what the process cannot reach: a library has functions that only
  /// other programs call.
  void removeUnreached();

  /// The module of all units; empty if no unit has bitcode.
  llvm::Module &module() { return *Process; }
  llvm::ArrayRef<LeftOut> leftOut() const { return Missing; }
  /// The functions that each unit defines, by their names in the unit, sorted.
  llvm::ArrayRef<std::vector<std::string>> functions() const {
    return Functions;
  }

private:
  struct UnitModule;

  void leaveOut(llvm::StringRef Unit, const llvm::Twine &File, std::string Why);
  std::unique_ptr<llvm::Module> read(const UnitModule &Of,
                                     llvm::MemoryBufferRef Buffer);
  void addFile(UnitModule &To, const UnitFiles::File &File);
  void addArchive(UnitModule &To, const UnitFiles::File &File,
                  llvm::MemoryBufferRef Buffer);
  void addObject(UnitModule &To, llvm::MemoryBufferRef Buffer, bool IsLazy);
  void addNeededMembers(UnitModule &To);
  bool link(UnitModule &To, std::unique_ptr<llvm::Module> From);

  llvm::LLVMContext Ctx;
  std::string Complaint; ///< what LLVM said last
  std::unique_ptr<llvm::Module> Process;
  std::vector<std::unique_ptr<UnitModule>> Units; ///< until they are joined
  llvm::StringMap<std::string> Renamed;           ///< see Symbols
  std::vector<LeftOut> Missing;
  std::vector<std::vector<std::string>> Functions;
};

} // namespace tpc

#endif // TPC_MERGER_H
