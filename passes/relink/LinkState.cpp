//===- LinkState.cpp ------------------------------------------------------===//
#include "relink/LinkState.h"

#include "relink/Interface.h"

#include "llvm/ADT/STLExtras.h"
#include "llvm/ADT/SmallString.h"
#include "llvm/ADT/StringExtras.h"
#include "llvm/Support/Error.h"
#include "llvm/Support/FileSystem.h"
#include "llvm/Support/JSON.h"
#include "llvm/Support/MemoryBuffer.h"
#include "llvm/Support/xxhash.h"

#include <optional>

using namespace llvm;

namespace tpc {

/// Another format is not read: the link is run.
static constexpr int64_t StateSchema = 1;

namespace {
/// What a file that a link read says now.
struct Input {
  std::string Digest;
  std::optional<Interface> Shared; ///< of a shared library that is linked
};
/// What it said then.
struct RecordedInput {
  std::string Digest;
  std::vector<uint64_t> Undefined; ///< of a shared library of the workspace
};
} // namespace

/// The text behind \p Option in \p Word, up to a comma of `-Wl,`.
static std::optional<StringRef> valueOf(StringRef Word, StringRef Option) {
  size_t At = Word.find(Option);
  if (At == StringRef::npos)
    return std::nullopt;
  return Word.drop_front(At + Option.size()).split(',').first;
}

LinkCommandLine readCommand(ArrayRef<std::string> Words) {
  LinkCommandLine Out;
  Out.Words = Words.vec();
  for (const auto &[N, Word] : enumerate(Words)) {
    if (Word == "-o" && N + 1 < Words.size())
      Out.Output = Words[N + 1];
    for (auto [Option, File] :
         {std::pair("-tpc-manifest=", &Out.Manifest),
          std::pair("-tpc-static-info=", &Out.StaticInfo),
          std::pair("-tpc-plans=", &Out.Plans),
          std::pair("--dependency-file=", &Out.Dependencies)})
      if (auto Value = valueOf(Word, Option))
        *File = Value->str();
    for (StringRef Option :
         {"-tpc-rules=", "--load-pass-plugin=", "--ld-path="})
      if (auto Value = valueOf(Word, Option))
        Out.Tools.push_back(Value->str());
  }
  return Out;
}

static std::string digest(StringRef Text) {
  XXH128_hash_t Hash = xxh3_128bits(arrayRefFromStringRef(Text));
  return utohexstr(Hash.high64) + "-" + utohexstr(Hash.low64);
}

static bool isThinArchive(const Twine &Path) {
  auto Start = MemoryBuffer::getFileSlice(Path, 8, 0);
  return Start && (*Start)->getBuffer() == "!<thin>\n";
}

static std::optional<std::string> digestOfFile(const Twine &Path) {
  auto Buffer = MemoryBuffer::getFile(Path, /*IsText=*/false,
                                      /*RequiresNullTerminator=*/false);
  if (!Buffer)
    return std::nullopt;
  return digest((*Buffer)->getBuffer());
}

/// Without looking inside.
static std::string stampOf(StringRef Path) {
  sys::fs::file_status Status;
  if (sys::fs::status(Path, Status))
    return "";
  auto Time = Status.getLastModificationTime().time_since_epoch().count();
  return utostr(Status.getSize()) + " " + itostr(Time);
}

/// The command, with what is in its response files.
static std::string digestOfCommand(const LinkCommandLine &Command) {
  std::string Text;
  for (StringRef Word : Command.Words) {
    Text += Word;
    Text += '\0';
    if (Word.consume_front("@"))
      Text += digestOfFile(Word).value_or("");
  }
  SmallString<256> Folder;
  sys::fs::current_path(Folder);
  Text += Folder;
  // Another version of the compiler, and so of the linker.
  Text += stampOf(Command.Words.front());
  return digest(Text);
}

/// The files that the linker read, from the first rule of what it lists for
/// make; empty if that cannot be read.
static std::vector<std::string> filesRead(StringRef Path) {
  std::vector<std::string> Files;
  auto Text = MemoryBuffer::getFile(Path);
  if (!Text)
    return Files;
  std::string File;
  auto End = [&] {
    if (!File.empty())
      Files.push_back(std::exchange(File, {}));
  };
  StringRef Rest = (*Text)->getBuffer();
  while (!Rest.empty()) {
    if (Rest.consume_front("\\\n")) {
      End();
    } else if (Rest.consume_front("$$")) {
      File += '$';
    } else if (Rest.front() == '\\' && Rest.size() > 1) {
      File += Rest[1];
      Rest = Rest.drop_front(2);
    } else if (Rest.front() == '\n') {
      break;
    } else if (Rest.front() == ' ') {
      End();
      Rest = Rest.drop_front();
    } else {
      File += Rest.front();
      Rest = Rest.drop_front();
    }
  }
  End();
  if (Files.empty() || !StringRef(Files.front()).ends_with(":"))
    return {};
  Files.erase(Files.begin());
  return Files;
}

/// Libraries of the system change with an update of it alone.
static bool isOfSystem(StringRef Path) {
  return Path.starts_with("/usr/lib") || Path.starts_with("/lib");
}

/// A shared library that is linked counts by its interface alone.
static constexpr StringRef ByInterface = "interface ";

/// What the file at \p Path says; with \p IsLinked, a shared library is known
/// by its interface. None of a thin archive: the linker does not list its
/// members.
static std::optional<Input> read(StringRef Path, bool IsLinked) {
  if (IsLinked)
    if (std::optional<Interface> Shared = interfaceOf(Path))
      return Input{(ByInterface + utohexstr(Shared->Digest)).str(), Shared};
  std::optional<std::string> Digest = digestOfFile(Path);
  if (!Digest || isThinArchive(Path))
    return std::nullopt;
  return Input{std::move(*Digest), std::nullopt};
}

static json::Object describe(StringRef Path, const Input &In) {
  json::Array Undefined;
  if (In.Shared && !isOfSystem(Path))
    append_range(Undefined, In.Shared->Undefined);
  return json::Object{{"digest", In.Digest},
                      {"undefined", std::move(Undefined)}};
}

static bool fromJSON(const json::Value &V, RecordedInput &In, json::Path P) {
  json::ObjectMapper O(V, P);
  return O && O.map("digest", In.Digest) && O.map("undefined", In.Undefined);
}

static bool isListed(const std::vector<uint64_t> &Sorted, uint64_t Name) {
  return std::binary_search(Sorted.begin(), Sorted.end(), Name);
}

/// True if \p Before describes the files as they are now. A shared library may
/// need more than before if another one has it: the linker would find it.
static bool areSame(const json::Object &Before) {
  std::vector<uint64_t> Needed, Defined;
  json::Path::Root Ignored;
  for (const auto &[Path, Value] : Before) {
    RecordedInput Known;
    if (!fromJSON(Value, Known, Ignored))
      return false;
    std::optional<Input> Now =
        read(Path, StringRef(Known.Digest).starts_with(ByInterface));
    if (!Now || Now->Digest != Known.Digest)
      return false;
    if (!Now->Shared)
      continue;
    append_range(Defined, Now->Shared->Defined);
    if (!isOfSystem(Path))
      copy_if(Now->Shared->Undefined, std::back_inserter(Needed),
              [&](uint64_t Name) { return !isListed(Known.Undefined, Name); });
  }
  llvm::sort(Defined);
  return all_of(Needed, [&](uint64_t Name) { return isListed(Defined, Name); });
}

static std::optional<json::Object> readJsonObject(StringRef Path) {
  auto Text = MemoryBuffer::getFile(Path);
  if (!Text)
    return std::nullopt;
  Expected<json::Value> Read = json::parse((*Text)->getBuffer());
  if (!Read) {
    consumeError(Read.takeError());
    return std::nullopt;
  }
  if (json::Object *Found = Read->getAsObject())
    return std::move(*Found);
  return std::nullopt;
}

/// True if the last link of the unit waited for the analysis of its processes.
static bool wasDelayed(const LinkCommandLine &Command) {
  std::optional<json::Object> Manifest = readJsonObject(Command.Manifest);
  return !Manifest || Manifest->getBoolean("later").value_or(true);
}

static std::optional<json::Object> readState(const LinkCommandLine &Command) {
  std::optional<json::Object> State = readJsonObject(Command.stateFile());
  if (!State || State->getInteger("schema") != StateSchema)
    return std::nullopt;
  return State;
}

bool isUpToDate(const LinkCommandLine &Command) {
  std::optional<json::Object> State = readState(Command);
  if (!State || !sys::fs::exists(Command.StaticInfo) || wasDelayed(Command))
    return false;
  const json::Object *Files = State->getObject("inputs");
  return Files && State->getString("output") == digestOfFile(Command.Output) &&
         State->getString("command") == digestOfCommand(Command) &&
         State->getString("plans") ==
             digestOfFile(Command.planFile()).value_or("") &&
         areSame(*Files);
}

/// True if \p Path was written after \p Start: the link may have read less.
static bool isNewer(const Twine &Path, sys::TimePoint<> Start) {
  sys::fs::file_status Status;
  return !sys::fs::status(Path, Status) &&
         Status.getLastModificationTime() >= Start;
}

void recordState(const LinkCommandLine &Command, sys::TimePoint<> Start) {
  if (wasDelayed(Command) || isNewer(Command.planFile(), Start))
    return;
  std::vector<std::string> Files = filesRead(Command.Dependencies);
  if (Files.empty())
    return;
  json::Object All;
  for (bool IsLinked : {true, false})
    for (const std::string &File : IsLinked ? Files : Command.Tools) {
      std::optional<Input> In = read(File, IsLinked);
      if (!In || !json::isUTF8(File) || isNewer(File, Start))
        return;
      All[File] = describe(File, *In);
    }
  const json::Value State =
      json::Object{{"schema", StateSchema},
                   {"output", digestOfFile(Command.Output).value_or("")},
                   {"command", digestOfCommand(Command)},
                   {"plans", digestOfFile(Command.planFile()).value_or("")},
                   {"inputs", std::move(All)}};
  // Without the file the next link is run; nothing else is lost.
  consumeError(writeToOutput(Command.stateFile(), [&](raw_ostream &OS) {
    OS << State << '\n';
    return Error::success();
  }));
}

} // namespace tpc
