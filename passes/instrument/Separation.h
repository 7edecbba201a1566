//===- Separation.h - Copies functions for single calls -------------------===//
//
// A report inside a function stands for all of its calls. Where these must be
// told apart, each gets a copy of the function.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_SEPARATION_H
#define TPC_SEPARATION_H

#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Module.h"
#include "llvm/Transforms/Utils/ValueMapper.h"

#include <string>
#include <vector>

namespace tpc {

class Rules;

/// A call, and its number in its function.
struct NumberedCall {
  llvm::CallBase *Call;
  unsigned Number;
};

/// Copies functions, within the limit of one round.
class Copier {
public:
  /// Gives each call of \p F its own copy of it, so that the arguments of one
  /// call are not mixed with those of another. If \p KeepsOwn, \p F itself
  /// serves the first call; otherwise it serves only calls from elsewhere.
  /// Returns all calls; none if \p F is null, or has not enough calls, or
  /// cannot be copied.
  llvm::SmallVector<NumberedCall, 8> separate(llvm::Function *F,
                                              bool KeepsOwn = true);

private:
  size_t Added = 0; ///< instructions
};

/// Copies \p F under a name of its own; \p Map gets what each value became.
llvm::Function *cloneAs(const llvm::Twine &Name, llvm::Function &F,
                        llvm::ValueToValueMapTy &Map);

/// The calls of \p F from other functions, in the order of the module: the
/// order of a use list differs between two copies of a module.
llvm::SmallVector<NumberedCall, 8> callsOf(llvm::Function &F);

/// The instructions of \p F without markers that only some optimisation levels
/// add.
unsigned sizeOf(const llvm::Function &F);

/// Replaces calls of an alias in \p M by calls of the function: above -O0 the
/// constructors of a class are one function with two names.
void callByOwnName(llvm::Module &M);

/// A function that was copied for each of its calls.
struct CopiedFunction {
  struct Call {
    std::string Caller;
    unsigned Number;    ///< of the call in its function
    std::string Callee; ///< what serves it now
  };
  std::string Name;
  std::vector<Call> Calls;
};

/// A function that was copied, and its calls; all but the first call a copy.
struct SeparatedFunction {
  llvm::Function *From;
  llvm::SmallVector<NumberedCall, 8> Calls;
};

/// Changes a program before reports are inserted: functions whose comparisons
/// count as their callers' are inlined, and functions whose calls must be
/// distinguished are copied for each call. Applied to two copies of a program,
/// the results are again the same program.
class Separation {
public:
  /// \p Tables name the functions to inline.
  explicit Separation(const Rules &Tables) : Tables(Tables) {}
  /// Inlines in \p M; true if there was something to inline.
  bool inlineTransparentIn(llvm::Module &M) const;
  /// In \p M, where everything up to now was done, also copies each function of
  /// \p Names for each of its calls. Returns those that could be copied.
  std::vector<SeparatedFunction> separateIn(llvm::Module &M,
                                            std::vector<std::string> Names);
  /// Does it all in \p M, which is as the program was.
  void applyTo(llvm::Module &M) const;

private:
  const Rules &Tables;
  std::vector<std::vector<std::string>> Rounds;
};

} // namespace tpc

#endif // TPC_SEPARATION_H
