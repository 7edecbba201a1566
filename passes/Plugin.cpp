//===- Plugin.cpp - Registration ------------------------------------------===//
//
// Registers the passes with lld (full link-time optimisation, at its first
// extension point) and with opt (`-passes=...`). Nothing else.
//
//===----------------------------------------------------------------------===//
#include "LinkUnit.h"
#include "Rules.h"
#include "calls/SimpleCallGraph.h"
#include "control/IfStatements.h"
#include "instrument/InstrumentBranches.h"
#include "instrument/Prepare.h"
#include "memory/AccessIndex.h"
#include "memory/PointsTo.h"
#include "memory/VisibleWrites.h"
#include "params/ParamCallFinder.h"
#include "params/ParamUsageFinder.h"
#include "results/GatherResults.h"
#include "results/LoopDepths.h"
#include "slice/BackwardPropagate.h"
#include "slice/ExternCallFinder.h"
#include "support/Compat.h"

using namespace llvm;
using namespace tpc;

static bool addPass(StringRef Name, ModulePassManager &MPM,
                    ArrayRef<PassBuilder::PipelineElement>) {
#define PRINTER(NAME, CLASS)                                                   \
  if (Name == "print<" NAME ">") {                                             \
    MPM.addPass(CLASS(outs()));                                                \
    return true;                                                               \
  }
  PRINTER("tpc-callgraph", SimpleCallGraphPrinter)
  PRINTER("tpc-class-object-access", ClassObjectAccessPrinter)
  PRINTER("tpc-points-to", PointsToPrinter)
  PRINTER("tpc-visible-writes", VisibleWritesPrinter)
  PRINTER("tpc-if-statements", IfStatementsPrinter)
  PRINTER("tpc-extern-calls", ExternCallFinderPrinter)
  PRINTER("tpc-param-calls", ParamCallFinderPrinter)
  PRINTER("tpc-backward-propagate", BackwardPropagatePrinter)
  PRINTER("tpc-param-usage", ParamUsageFinderPrinter)
  PRINTER("tpc-gather-results", GatherResultsPrinter)
  PRINTER("tpc-loop-depths", LoopDepthsPrinter)
  PRINTER("tpc-instrument-branches", InstrumentBranchesPrinter)
#undef PRINTER
  if (Name == "tpc-prepare") {
    MPM.addPass(PreparePass());
    return true;
  }
  if (Name == "tpc") {
    MPM.addPass(LinkUnitPass());
    return true;
  }
  return false;
}

static void registerPasses(PassBuilder &PB) {
  PB.registerAnalysisRegistrationCallback(registerAnalyses);
  PB.registerPipelineParsingCallback(addPass);
  PB.registerFullLinkTimeOptimizationEarlyEPCallback(
      [&PB](ModulePassManager &MPM, OptimizationLevel) {
        MPM.addPass(LinkUnitPass());
        MPM.addPass(PrelinkPass(PB));
      });
}

extern "C" LLVM_ATTRIBUTE_WEAK PassPluginLibraryInfo llvmGetPassPluginInfo() {
  return {LLVM_PLUGIN_API_VERSION, "tpc", TPC_VERSION, registerPasses};
}
