//===- Defer.cpp - The compiler's own passes wait for the link ------------===//
//
// A plugin for clang. What the files of a link unit are analysed as is what
// clang made of the source, so of its passes none runs but those that must; the
// rest does at the link (PrelinkPass). What that would keep alive is given up
// here: an optimised file no longer has the inline functions that went into
// their callers, and an executable or library has then not to export them.
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

/// True where \p F is only ever called. Where no file of a link unit asks for
/// its address, nobody can tell which copy of an inline function is called.
static bool isOnlyCalled(const Function &F) {
  return all_of(F.uses(), [](const Use &U) {
    const auto *Call = dyn_cast<CallBase>(U.getUser());
    return Call && Call->isCallee(&U);
  });
}

/// True where the body of \p F is in a header of the system's or of ROS: who
/// calls it has it as well. Of one that stands elsewhere there may be no other
/// body: that of a template in a source file, say.
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

/// True while a file with coroutines is compiled. The passes that must run take
/// half of a coroutine apart, and the rest of it cannot be left to the link.
static bool HasCoroutines = false;

namespace {
struct PrepareForLink : PassInfoMixin<PrepareForLink> {
  static bool isRequired() { return true; }

  PreservedAnalyses run(Module &M, ModuleAnalysisManager &) {
    HasCoroutines = false;
    for (Function &F : M) {
      // Has the linker export no inline function for the sake of its address.
      if (F.hasLinkOnceODRLinkage() && isOnlyCalled(F) && isOfSystem(F))
        F.setUnnamedAddr(GlobalValue::UnnamedAddr::Global);
      // The passes of sanitizers are among those that must run.
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
    Callbacks->registerShouldRunOptionalPassCallback([](StringRef Pass, Any) {
      return HasCoroutines && (Pass == "ModuleInlinerWrapperPass" ||
                               Pass == "DevirtSCCRepeatedPass");
    });
}

extern "C" LLVM_ATTRIBUTE_WEAK PassPluginLibraryInfo llvmGetPassPluginInfo() {
  return {LLVM_PLUGIN_API_VERSION, "tpc-defer", TPC_VERSION, registerPasses};
}
