//===- Describer.h - What the analyses found, as JSON ---------------------===//
//
// docs/reference/formats.md.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_DESCRIBER_H
#define TPC_DESCRIBER_H

#include "calls/SimpleCallGraph.h"
#include "control/IfStatements.h"
#include "memory/Variables.h"
#include "memory/VisibleWrites.h"
#include "output/ExplainInfo.h"
#include "params/ParamCallFinder.h"
#include "results/LoopDepths.h"
#include "results/Messages.h"
#include "slice/ExternCallFinder.h"

namespace tpc {

/// Writes what the analyses of a module found.
class Describer {
public:
  Describer(llvm::Module &M, llvm::ModuleAnalysisManager &AM,
            const Options &Opts)
      : M(M), Opts(Opts), Writes(AM.getResult<VisibleWritesAnalysis>(M)),
        Pointers(AM.getResult<PointsToAnalysis>(M)),
        Ifs(AM.getResult<IfStatements>(M)),
        Exposing(AM.getResult<ExternCallFinder>(M)),
        Reads(AM.getResult<ParamCallFinder>(M)),
        Calls(AM.getResult<SimpleCallGraph>(M)),
        Usage(AM.getResult<ParamUsageFinder>(M)),
        Slice(AM.getResult<BackwardPropagate>(M)),
        Gathered(AM.getResult<GatherResults>(M)),
        Loops(AM.getResult<LoopDepths>(M)),
        Names(AM.getResult<LocationTypesAnalysis>(M)), Received(M, AM),
        Explain(M, AM, Opts) {}

  llvm::json::Array parameters() const;
  llvm::json::Array exposing() const;
  std::vector<SourcePlace> comparisons() const;
  llvm::json::Object comparison(const SourcePlace &P);
  unsigned loopDepth(const Comparison &C) const { return Loops.of(C); }
  ExplainInfo &explain() { return Explain; }
  llvm::json::Object counts(llvm::ArrayRef<SourcePlace> Comparisons) const;

private:
  llvm::json::Object placed(const llvm::DILocation *Loc,
                            const llvm::Function &F) const;
  llvm::json::Object placed(const llvm::Instruction &I) const {
    return placed(I.getDebugLoc(), *I.getFunction());
  }
  llvm::json::Value where(const llvm::Instruction &I) const;
  std::string source(const Comparison &C) const;
  std::string variable(const Comparison &C) const;
  llvm::json::Array received(const Comparison &C);

  llvm::Module &M;
  const Options &Opts;
  const VisibleWrites &Writes;
  PointsTo &Pointers;
  const IfStatementsResult &Ifs;
  const ExternCallFinder::Result &Exposing;
  const ParamCallFinder::Result &Reads;
  const CallGraphResult &Calls;
  const ParameterUsage &Usage;
  const SliceResult &Slice;
  const GatheredResults &Gathered;
  const LoopDepthsResult &Loops;
  VariableNames Names;
  Messages Received;
  ExplainInfo Explain;
  SourceLines Lines;
};

} // namespace tpc

#endif // TPC_DESCRIBER_H
