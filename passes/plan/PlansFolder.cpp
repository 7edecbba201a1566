//===- PlansFolder.cpp ----------------------------------------------------===//
#include "plan/PlansFolder.h"

#include "plan/CommandLine.h"
#include "plan/Manifest.h"

#include "llvm/ADT/SmallString.h"
#include "llvm/ADT/StringRef.h"
#include "llvm/Support/CommandLine.h"
#include "llvm/Support/FileSystem.h"
#include "llvm/Support/MemoryBuffer.h"
#include "llvm/Support/Path.h"

using namespace llvm;

namespace tpc {

static cl::opt<std::string>
    PlansOpt("tpc-plans",
             cl::desc("As -tpc-plan, for each file *.json of this folder. "
                      "While it has a file `later`, libraries are not analysed "
                      "yet, and neither is what uses those below the folder "
                      "that the file names"));

std::vector<std::string> plansOfFolder() {
  std::vector<std::string> Plans;
  std::error_code Bad;
  if (!PlansOpt.empty())
    for (sys::fs::directory_iterator It(PlansOpt, Bad), End; It != End && !Bad;
         It.increment(Bad))
      if (sys::path::extension(It->path()) == ".json")
        Plans.push_back(It->path());
  llvm::sort(Plans);
  return Plans;
}

bool isAnalysedLater() {
  if (PlansOpt.empty())
    return false;
  SmallString<256> File(PlansOpt);
  sys::path::append(File, "later");
  auto Text = MemoryBuffer::getFile(File);
  if (!Text)
    return false;
  const LinkCommand Link = ownLinkCommand();
  // The plans may be about other code than this.
  if (Link.IsShared || !plansOfFolder().empty())
    return true;
  SmallString<256> Base;
  if (sys::fs::real_path((*Text)->getBuffer().trim(), Base))
    return false;
  const std::string Folder = (Base + "/").str();
  return any_of(Link.Inputs, [&](const LinkInput &In) {
    return isSharedLibraryBelow(In, Link.LibraryFolders, Folder);
  });
}

} // namespace tpc
