//===- BlindSpots.h - Where the analysis does not see on ------------------===//
//
// What could not be resolved, place by place: the reader of a result should
// know what it does not say. One list; a new kind is a name in BlindSpot and
// the places where it occurs.
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
  /// In the order in which they are listed: where there are very many, the
  /// last ones are only counted.
  enum KindTy {
    LostValue,        ///< a parameter's value is not followed on
    LostOutcome,      ///< the outcome of a comparison with it is not
    UnknownPointer,   ///< a value goes through a pointer to nowhere known
    ManyTargets,      ///< a value goes to one of very many variables
    Unread,           ///< a value is stored, and nothing here loads it
    DynamicName,      ///< a parameter's name is not constant
    OutsideSources,   ///< a comparison in code that is not the user's
    WithoutDebugInfo, ///< a comparison that has no place in a source
    IndirectCall,     ///< a call whose function is not known
  };
  KindTy Kind;
  const llvm::Instruction *At;
  static constexpr unsigned None = ~0U;
  unsigned Read = None;    ///< number of the read; None where it is about none
  bool IsNoNumber = false; ///< a lost value, for it is of no type of numbers

  llvm::StringRef kindName() const;
  /// What it is, in a few words.
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
