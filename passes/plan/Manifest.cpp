//===- Manifest.cpp -------------------------------------------------------===//
#include "plan/Manifest.h"

#include "plan/PlansFolder.h"

#include "llvm/BinaryFormat/Magic.h"
#include "llvm/Config/llvm-config.h"
#include "llvm/Support/FileSystem.h"
#include "llvm/Support/Path.h"

using namespace llvm;

namespace tpc {

static constexpr int SchemaVersion = 1;

static std::string absolute(StringRef Path) {
  SmallString<256> Whole(Path);
  sys::fs::make_absolute(Whole);
  sys::path::remove_dots(Whole, /*remove_dot_dot=*/true);
  return json::fixUTF8(Whole);
}

static json::Array texts(ArrayRef<std::string> Words) {
  json::Array List;
  for (const std::string &Word : Words)
    List.push_back(json::fixUTF8(Word));
  return List;
}

/// What the file \p Path is: `bitcode`, `native` or `archive` for an object;
/// empty for a library, a script, and what cannot be read.
static StringRef objectKind(StringRef Path) {
  file_magic Magic;
  if (identify_magic(Path, Magic))
    return "";
  switch (Magic) {
  case file_magic::bitcode:
    return "bitcode";
  case file_magic::elf_relocatable:
    return "native";
  case file_magic::archive:
    return "archive";
  default:
    return "";
  }
}

/// The file that `-l` \p In stands for, as the linker looks for it; empty if
/// there is none.
static std::string findLibrary(const LinkInput &In,
                               ArrayRef<std::string> Folders) {
  StringRef Name = In.Name;
  SmallVector<std::string, 2> Files;
  if (Name.consume_front(":")) {
    Files.push_back(Name.str());
  } else {
    if (!In.Static)
      Files.push_back(("lib" + Name + ".so").str());
    Files.push_back(("lib" + Name + ".a").str());
  }
  for (const std::string &Folder : Folders)
    for (const std::string &File : Files) {
      SmallString<256> Path(Folder);
      sys::path::append(Path, File);
      if (sys::fs::exists(Path))
        return std::string(Path);
    }
  return "";
}

static json::Object optionsOf(const Options &Opts) {
  return json::Object{
      {"analyse", Opts.Analyse},
      {"constants", Opts.Constants},
      {"excluded", texts(Opts.Excluded)},
      {"instrument", Opts.Instrument},
      {"max_memory", Opts.MaxMemory},
      {"max_seconds", Opts.MaxSeconds},
      {"plans", texts(Opts.Plans)},
      {"profile", Opts.Profile},
      {"rules", texts(Opts.RuleFiles)},
      {"static_info", Opts.StaticInfo.empty()
                          ? json::Value(nullptr)
                          : json::Value(absolute(Opts.StaticInfo))}};
}

LinkCommand ownLinkCommand() {
  const std::vector<std::string> Words = ownCommandLine();
  return readLinkCommand(Words.empty()
                             ? ArrayRef<std::string>()
                             : ArrayRef<std::string>(Words).drop_front());
}

bool isSharedLibraryBelow(const LinkInput &In, ArrayRef<std::string> Folders,
                          StringRef Beginning) {
  const std::string Path = In.IsLibrary ? findLibrary(In, Folders) : In.Name;
  file_magic Magic;
  SmallString<256> Real;
  return !Path.empty() && !sys::fs::real_path(Path, Real) &&
         Real.starts_with(Beginning) && !identify_magic(Path, Magic) &&
         Magic == file_magic::elf_shared_object;
}

json::Object describeLink(const Options &Opts) {
  const LinkCommand Link = ownLinkCommand();
  json::Array Objects, Libraries;
  for (const LinkInput &In : Link.Inputs) {
    const std::string Path =
        In.IsLibrary ? findLibrary(In, Link.LibraryFolders) : In.Name;
    StringRef Kind = objectKind(Path);
    json::Value File =
        Path.empty() ? json::Value(nullptr) : json::Value(absolute(Path));
    // An archive is both: its members become part of the unit.
    if (!Kind.empty())
      Objects.push_back(json::Object{{"path", File},
                                     {"kind", Kind},
                                     {"whole_archive", In.WholeArchive},
                                     {"lazy", In.Lazy}});
    if (In.IsLibrary || Kind.empty())
      Libraries.push_back(json::Object{
          {"given", json::fixUTF8(In.IsLibrary ? "-l" + In.Name : In.Name)},
          {"path", File},
          {"as_needed", In.AsNeeded},
          {"static", In.Static}});
  }
  SmallString<256> Folder;
  sys::fs::current_path(Folder);
  return json::Object{
      {"schema", SchemaVersion},
      {"link_unit", json::fixUTF8(Opts.LinkUnit)},
      {"package",
       json::fixUTF8(Opts.Package.empty() ? "unnamed" : Opts.Package)},
      {"source_root", json::fixUTF8(Opts.SourceRoot)},
      {"tool", json::Object{{"name", "tpc"},
                            {"version", TPC_VERSION},
                            {"llvm", LLVM_VERSION_STRING}}},
      {"folder", json::fixUTF8(Folder)},
      {"command", texts(ownCommandLine())},
      {"output", absolute(Link.Output)},
      {"soname",
       Link.SoName.empty() ? json::Value(nullptr) : json::fixUTF8(Link.SoName)},
      {"shared", Link.IsShared},
      {"later", isAnalysedLater()},
      {"objects", std::move(Objects)},
      {"libraries", std::move(Libraries)},
      {"library_folders", texts(Link.LibraryFolders)},
      {"run_paths", texts(Link.RunPaths)},
      {"options", optionsOf(Opts)}};
}

Error writeJsonText(const json::Value &V, StringRef Path) {
  StringRef Folder = sys::path::parent_path(Path);
  if (!Folder.empty())
    if (std::error_code EC = sys::fs::create_directories(Folder))
      return createFileError(Path, EC);
  return writeToOutput(Path, [&](raw_ostream &OS) {
    json::OStream(OS, /*IndentSize=*/1).value(V);
    OS << '\n';
    return Error::success();
  });
}

} // namespace tpc
