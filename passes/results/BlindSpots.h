//===- BlindSpots.h - Places that the analysis cannot resolve -------------===//
//
// Lists every place that could not be resolved: the reader of a result must
// know what it does not cover. There is one list. A new kind is a name in
// BlindSpot and the places where it occurs.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_BLINDSPOTS_H
#define TPC_BLINDSPOTS_H

#include "calls/SimpleCallGraph.h"
#include "params/ParamCallFinder.h"
#include "results/GatherResults.h"
#include "results/Wording.h"

namespace tpc {

struct BlindSpot {
  /// In the order of the list: if there are very many, the last ones are only
  /// counted.
  enum KindTy {
    LostValue,        ///< the value of a parameter is not followed further
    LostOutcome,      ///< the outcome of a comparison with it is not followed
                      ///< further
    UnknownPointer,   ///< a value goes through a pointer to an unknown place
    ManyTargets,      ///< a value goes to one of very many variables
    Unread,           ///< a value is stored, and nothing here loads it
    DynamicName,      ///< a parameter's name is not constant
    OutsideSources,   ///< a comparison in code that is not user code
    WithoutDebugInfo, ///< a comparison that has no place in the source
    IndirectCall,     ///< a call whose target is not known
  };
  KindTy Kind;
  const llvm::Instruction *At;
  static constexpr unsigned None = ~0U;
  /// The number of the read; None if the blind spot is not about a read.
  unsigned Read = None;
  bool IsNoNumber = false; ///< a lost value: its type is not a number

  llvm::StringRef kindName() const;
  /// The place in the order of kinds of the one called \p Name; 0 for others.
  static unsigned rankOf(llvm::StringRef Name);
  /// A short description.
  std::string text(const ParamCallFinder::Result &Reads,
                   const Wording &Words) const;
};

/// The blind spots of a module, in the order of the analyses.
std::vector<BlindSpot> findBlindSpots(const ParameterUsage &Usage,
                                      const ParamCallFinder::Result &Reads,
                                      const GatheredResults &Gathered,
                                      const CallGraphResult &Calls,
                                      Wording &Words);

} // namespace tpc

#endif // TPC_BLINDSPOTS_H
