//===- ParamCallFinder.h - The parameter reads ----------------------------===//
//
// Thesis A.9: which calls put the value of a parameter into a variable,
// according to the rules; with the name and the default of the parameter if
// they are constant.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_PARAMCALLFINDER_H
#define TPC_PARAMCALLFINDER_H

#include "Rules.h"

#include "llvm/ADT/SmallVector.h"
#include "llvm/Support/JSON.h"

namespace tpc {

struct ParameterRead {
  llvm::CallBase *Call;
  const Rule *Row;
  std::string Name; ///< `<dynamic>` stands for parts that are not constant
  std::string Type; ///< C++ type of the value, as demangled
  llvm::json::Value Default; ///< number, bool, string or null
  /// Where the value is written; null if it is the result of the call.
  llvm::Value *Target;
  /// Where the value first appears, if it is neither the result nor written by
  /// the call.
  llvm::SmallVector<llvm::Value *, 1> Values = {};
  std::string Field = {}; ///< for a field of a class: its name
  /// Identifies the read where its name is reported; empty without debug
  /// information. Reads of one name at one place share it.
  std::string Key = {};
  /// Of an object in a list that the call makes: its place, if the other places
  /// are other parameters.
  std::optional<unsigned> Index = std::nullopt;
};

/// \p C, a number of the C++ type \p Type, as JSON; null if it is not a number.
llvm::json::Value jsonOf(const llvm::Constant &C, llvm::StringRef Type);

class ParamCallFinder : public llvm::AnalysisInfoMixin<ParamCallFinder> {
public:
  /// In the order of the module.
  using Result = std::vector<ParameterRead>;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<ParamCallFinder>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-param-calls>`
class ParamCallFinderPrinter
    : public llvm::PassInfoMixin<ParamCallFinderPrinter> {
public:
  explicit ParamCallFinderPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_PARAMCALLFINDER_H
