//===- Defer.cpp - The compiler's own passes wait for the link ------------===//
//
// A plugin for clang. What the files of a link unit are analysed as is what
// clang made of the source, so of its passes none runs but those that must
// (what sanitizers are made of is among them) and those that count what is
// covered; the rest does at the link (PrelinkPass). What that would keep alive
// is given up here: an optimised file no longer has the inline functions that
// went into their callers, and an executable or library has then not to export
// them.
//
//===----------------------------------------------------------------------===//
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Module.h"
#include "llvm/Passes/PassBuilder.h"
#include "llvm/Passes/PassPlugin.h"

using namespace llvm;

/// True where \p F is only ever called. Where no file of a link unit asks for
/// its address, nobody can tell which copy of an inline function is called.
static bool isOnlyCalled(const Function &F) {
  return all_of(F.uses(), [](const Use &U) {
    const auto *Call = dyn_cast<CallBase>(U.getUser());
    return Call && Call->isCallee(&U);
  });
}

namespace {
/// Has the linker export no inline function for the sake of its address alone.
struct ReleaseInlineFunctions : PassInfoMixin<ReleaseInlineFunctions> {
  static bool isRequired() { return true; }

  PreservedAnalyses run(Module &M, ModuleAnalysisManager &) {
    for (Function &F : M)
      if (F.hasLinkOnceODRLinkage() && isOnlyCalled(F))
        F.setUnnamedAddr(GlobalValue::UnnamedAddr::Global);
    return PreservedAnalyses::all();
  }
};
} // namespace

static void registerPasses(PassBuilder &PB) {
  PB.registerPipelineStartEPCallback(
      [](ModulePassManager &MPM, OptimizationLevel) {
        MPM.addPass(ReleaseInlineFunctions());
      });
  if (PassInstrumentationCallbacks *Callbacks =
          PB.getPassInstrumentationCallbacks())
    Callbacks->registerShouldRunOptionalPassCallback([](StringRef Pass, Any) {
      return Pass == "GCOVProfilerPass" || Pass == "InstrProfilingLoweringPass";
    });
}

extern "C" LLVM_ATTRIBUTE_WEAK PassPluginLibraryInfo llvmGetPassPluginInfo() {
  return {LLVM_PLUGIN_API_VERSION, "tpc-defer", TPC_VERSION, registerPasses};
}
