//===- Defer.cpp - Postpones optimisation to the link ---------------------===//
//
// A plugin for clang. The link analyses the code as clang generated it from the
// source, so clang runs only those passes that it must; PrelinkPass runs the
// rest at the link. This plugin also makes up for two effects of optimisation
// that would be missed: an optimised file no longer contains the inline
// functions that were inlined everywhere, and the executable or library then
// does not export them.
//
//===----------------------------------------------------------------------===//
#include "support/Compat.h"
#include "support/SourcePath.h"

#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Module.h"
#include "llvm/Passes/PassBuilder.h"

using namespace llvm;
using namespace tpc;

/// True if \p F is only called. If no file of a link unit takes the address of
/// an inline function, nobody can tell which copy of it is called.
static bool isOnlyCalled(const Function &F) {
  return all_of(F.uses(), [](const Use &U) {
    const auto *Call = dyn_cast<CallBase>(U.getUser());
    return Call && Call->isCallee(&U);
  });
}

/// True if the body of \p F is in a system or ROS header: every caller has a
/// copy of it. A function from another file may have no other copy, such as a
/// template in a source file.
static bool isOfSystem(const Function &F) {
  const DISubprogram *SP = F.getSubprogram();
  if (!SP)
    return false;
  const std::string Path = pathOf(SP->getFile());
  return any_of(
      ArrayRef<StringRef>{"/usr/include/", "/usr/lib/", "/usr/local/include/",
                          "/opt/ros/"},
      [&](StringRef Folder) { return StringRef(Path).starts_with(Folder); });
}

/// True while a file with coroutines is compiled. The passes that must run
/// split coroutines halfway, and the rest of that work cannot wait for the
/// link.
static bool HasCoroutines = false;

namespace {
struct PrepareForLink : PassInfoMixin<PrepareForLink> {
  static bool isRequired() { return true; }

  PreservedAnalyses run(Module &M, ModuleAnalysisManager &) {
    HasCoroutines = false;
    for (Function &F : M) {
      // The linker need not export an inline function whose address is never
      // compared.
      if (F.hasLinkOnceODRLinkage() && isOnlyCalled(F) && isOfSystem(F))
        F.setUnnamedAddr(GlobalValue::UnnamedAddr::Global);
      // Sanitizer passes are among those that must run.
      for (Attribute::AttrKind Kind :
           {Attribute::SanitizeAddress, Attribute::SanitizeHWAddress,
            Attribute::SanitizeMemory, Attribute::SanitizeThread})
        F.removeFnAttr(Kind);
      HasCoroutines |= F.isPresplitCoroutine();
    }
    return PreservedAnalyses::all();
  }
};
} // namespace

static void registerPasses(PassBuilder &PB) {
  PB.registerPipelineStartEPCallback(
      [](ModulePassManager &MPM, OptimizationLevel) {
        MPM.addPass(PrepareForLink());
      });
  if (PassInstrumentationCallbacks *Callbacks =
          PB.getPassInstrumentationCallbacks())
    Callbacks->registerShouldRunOptionalPassCallback(
        [](StringRef Pass, const Any &) {
          return HasCoroutines && (Pass == "ModuleInlinerWrapperPass" ||
                                   Pass == "DevirtSCCRepeatedPass");
        });
}

extern "C" LLVM_ATTRIBUTE_WEAK PassPluginLibraryInfo llvmGetPassPluginInfo() {
  return {LLVM_PLUGIN_API_VERSION, "tpc-defer", TPC_VERSION, registerPasses};
}
