//===- Environment.cpp ----------------------------------------------------===//
#include "Environment.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>
#include <unistd.h>

namespace fs = std::filesystem;

namespace tpc {

static std::string variable(const char *Name) {
  const char *Value = std::getenv(Name);
  return Value ? Value : "";
}

/// True for the values that CMake takes for true.
static bool isOn(const char *Name) {
  std::string Value = variable(Name);
  std::transform(Value.begin(), Value.end(), Value.begin(),
                 [](unsigned char C) { return std::toupper(C); });
  return !(Value.empty() || Value == "0" || Value == "OFF" || Value == "NO" ||
           Value == "FALSE" || Value == "N" || Value == "IGNORE" ||
           Value == "NOTFOUND");
}

/// The working folder under the name that the shell uses, if that is correct:
/// clang writes this name into the debug information, which identifies files by
/// it.
static fs::path workingFolder() {
  std::error_code Failed;
  const fs::path Told = variable("PWD");
  if (Told.is_absolute() && fs::equivalent(Told, ".", Failed) && !Failed)
    return Told.lexically_normal();
  fs::path Folder = fs::current_path(Failed);
  return Failed ? fs::path("/") : Folder;
}

static bool isThere(const fs::path &Path) {
  std::error_code Failed;
  return fs::exists(Path, Failed);
}

/// The folder of the project: the nearest folder upward that is a ROS package;
/// otherwise the nearest one under git; otherwise \p Folder itself.
static fs::path projectOf(const fs::path &Folder) {
  for (const char *Marker : {"package.xml", ".git"})
    for (fs::path Above = Folder;; Above = Above.parent_path()) {
      if (isThere(Above / Marker))
        return Above;
      if (Above == Above.parent_path())
        break;
    }
  return Folder;
}

/// The name of a package in its manifest: the text of the first <name> outside
/// of comments. Empty if there is none.
static std::string nameInManifest(const fs::path &Manifest) {
  std::ifstream Stream(Manifest, std::ios::binary);
  std::string Text{std::istreambuf_iterator<char>(Stream), {}};
  for (size_t Start; (Start = Text.find("<!--")) != Text.npos;) {
    const size_t End = Text.find("-->", Start);
    Text.erase(Start, End == Text.npos ? Text.npos : End + 3 - Start);
  }
  constexpr std::string_view Opening = "<name>";
  const size_t Start = Text.find(Opening);
  const size_t End = Text.find("</name>");
  if (Start == Text.npos || End == Text.npos || End < Start)
    return "";
  std::istringstream Words(
      Text.substr(Start + Opening.size(), End - Start - Opening.size()));
  std::string Name;
  Words >> Name;
  return Name;
}

std::string clangVersion() {
  const std::string Chosen = variable("TPC_CLANG_VERSION");
  return Chosen.empty() ? TPC_CLANG_VERSION : Chosen;
}

std::string findProgram(const std::string &Name, const fs::path &Self) {
  std::istringstream Folders(variable("PATH"));
  std::vector<fs::path> Candidates;
  for (std::string Folder; std::getline(Folders, Folder, ':');)
    if (!Folder.empty() && Folder[0] == '/')
      Candidates.push_back(fs::path(Folder) / Name);
  Candidates.push_back(fs::path("/usr/bin") / Name);
  for (const fs::path &Candidate : Candidates) {
    std::error_code Failed;
    if (fs::is_regular_file(Candidate, Failed) &&
        access(Candidate.c_str(), X_OK) == 0 &&
        !fs::equivalent(Candidate, Self, Failed))
      return Candidate;
  }
  return "";
}

static std::string filledIn(std::string Word, const Environment &E) {
  for (const auto &[Place, Value] :
       {std::pair<std::string_view, std::string>{"@PREFIX@", E.Prefix},
        std::pair<std::string_view, std::string>{"@LLD@", E.Lld}})
    if (const size_t At = Word.find(Place); At != Word.npos)
      Word.replace(At, Place.size(), Value);
  return Word;
}

/// Reads the file of flags; false if it does not exist.
static bool readFlags(const fs::path &File, Environment &E) {
  std::ifstream Stream(File);
  if (!Stream)
    return false;
  for (std::string Line; std::getline(Stream, Line);) {
    std::istringstream Words(Line);
    std::string Kind;
    Words >> Kind;
    std::vector<std::string> *List = Kind == "compile"  ? &E.Added.Compile
                                     : Kind == "accept" ? &E.Added.Accept
                                     : Kind == "link"   ? &E.Added.Link
                                     : Kind == "linker" ? &E.Added.Linker
                                     : Kind == "log"    ? &E.Added.Log
                                     : Kind == "last"   ? &E.Added.Last
                                                        : nullptr;
    if (List)
      for (std::string Word; Words >> Word;)
        List->push_back(filledIn(std::move(Word), E));
  }
  return true;
}

/// A limit, if it is a number: any other text would make the link fail.
static std::string limit(const char *Name, Environment &E) {
  std::string Value = variable(Name);
  if (Value.find_first_not_of("0123456789") == Value.npos && Value.size() < 10)
    return Value;
  E.Complaints.push_back(std::string(Name) +
                         " is not a number and is ignored: " + Value);
  return "";
}

Environment Environment::read(const fs::path &Self) {
  Environment E;
  E.Prefix = Self.parent_path().parent_path();
  E.WorkingFolder = workingFolder();
  const std::string Root = variable("TPC_SOURCE_ROOT");
  E.SourceRoot = Root.empty() ? projectOf(E.WorkingFolder)
                              : (E.WorkingFolder / Root).lexically_normal();
  if (!E.SourceRoot.has_filename() && E.SourceRoot.has_relative_path())
    E.SourceRoot = E.SourceRoot.parent_path();
  E.Package = variable("TPC_PACKAGE");
  if (E.Package.empty())
    E.Package = nameInManifest(E.SourceRoot / "package.xml");
  if (E.Package.empty())
    E.Package = E.SourceRoot.filename();
  if (const std::string Folder = variable("TPC_STATIC_INFO"); !Folder.empty())
    E.StaticInfo = (E.WorkingFolder / Folder).lexically_normal();
  if (const std::string File = variable("TPC_RULES"); !File.empty())
    E.Rules = (E.WorkingFolder / File).lexically_normal();
  E.Profile = variable("TPC_PROFILE");
  E.MaxSeconds = limit("TPC_MAX_SECONDS", E);
  E.MaxMemory = limit("TPC_MAX_MEMORY", E);
  E.Constants = isOn("TPC_CONSTANTS");
  E.IsDisabled = isOn("TPC_DISABLE");
  E.Lld = findProgram("ld.lld-" + clangVersion(), Self);
  if (E.Lld.empty())
    E.Missing = "ld.lld-" + clangVersion() +
                " is not installed (apt-get install lld-" + clangVersion() +
                ")";
  if (clangVersion() != TPC_CLANG_VERSION)
    E.Missing = "TPC_CLANG_VERSION is " + clangVersion() +
                ", and the plugins are for clang " TPC_CLANG_VERSION;
  for (const char *Part :
       {"lib/tpc/TpcDefer.so", "lib/tpc/TpcPasses.so", "lib/libtpc_log.so"})
    if (!isThere(E.Prefix / Part))
      E.Missing = (E.Prefix / Part).string() + " is missing";
  const fs::path File = E.Prefix / "share/tpc/flags";
  if (!readFlags(File, E))
    E.Missing = File.string() + " is missing";
  return E;
}

} // namespace tpc
