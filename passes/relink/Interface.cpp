//===- Interface.cpp ------------------------------------------------------===//
#include "relink/Interface.h"

#include "llvm/ADT/STLExtras.h"
#include "llvm/Object/ELFObjectFile.h"
#include "llvm/Support/Error.h"
#include "llvm/Support/raw_ostream.h"
#include "llvm/Support/xxhash.h"

using namespace llvm;
using namespace llvm::object;

namespace tpc {

/// What \p Symbol, which is defined, means for a link. Addresses do not count.
static std::string describe(const ELFSymbolRef &Symbol, StringRef Name,
                            StringRef Version) {
  std::string Text;
  raw_string_ostream OS(Text);
  OS << Name << '@' << Version << ' ' << unsigned(Symbol.getELFType()) << ' '
     << unsigned(Symbol.getBinding()) << ' ' << unsigned(Symbol.getOther());
  // A program may have a copy of a variable.
  if (Symbol.getELFType() == ELF::STT_OBJECT ||
      Symbol.getELFType() == ELF::STT_TLS)
    OS << ' ' << Symbol.getSize();
  return Text;
}

/// The name by which \p File is needed; empty if it has none.
static Expected<StringRef> sonameOf(const ELF64LEObjectFile &File) {
  auto Entries = File.getELFFile().dynamicEntries();
  if (!Entries)
    return Entries.takeError();
  std::optional<uint64_t> Name;
  StringRef Texts;
  for (const auto &Entry : *Entries)
    if (Entry.getTag() == ELF::DT_SONAME) {
      Name = Entry.getVal();
    } else if (Entry.getTag() == ELF::DT_STRTAB) {
      auto At = File.getELFFile().toMappedAddr(Entry.getPtr());
      if (!At)
        return At.takeError();
      Texts = StringRef(reinterpret_cast<const char *>(*At),
                        File.getData().bytes_end() - *At);
    }
  if (!Name || *Name >= Texts.size())
    return "";
  return Texts.drop_front(*Name).split('\0').first;
}

static Expected<Interface> read(const ELF64LEObjectFile &File) {
  std::vector<std::string> Texts;
  Expected<StringRef> Soname = sonameOf(File);
  if (!Soname)
    return Soname.takeError();
  Texts.push_back(Soname->str());
  auto Versions = File.readDynsymVersions();
  if (!Versions)
    return Versions.takeError();
  Interface Out;
  for (const auto &[N, Symbol] : enumerate(File.getDynamicSymbolIterators())) {
    Expected<StringRef> Name = Symbol.getName();
    Expected<uint32_t> Flags = Symbol.getFlags();
    if (!Name || !Flags)
      return joinErrors(Name.takeError(), Flags.takeError());
    uint64_t Hash = xxh3_64bits(*Name);
    if (*Flags & SymbolRef::SF_Undefined) {
      Out.Undefined.push_back(Hash);
      continue;
    }
    Out.Defined.push_back(Hash);
    Texts.push_back(describe(Symbol, *Name,
                             N < Versions->size() ? (*Versions)[N].Name : ""));
  }
  llvm::sort(Out.Defined);
  llvm::sort(Out.Undefined);
  llvm::sort(Texts);
  Out.Digest = xxh3_64bits(join(Texts, "\n"));
  return Out;
}

std::optional<Interface> interfaceOf(StringRef Path) {
  auto File = ObjectFile::createObjectFile(Path);
  if (!File) {
    consumeError(File.takeError());
    return std::nullopt;
  }
  const auto *Elf = dyn_cast<ELFObjectFileBase>(File->getBinary());
  const auto *Own = dyn_cast<ELF64LEObjectFile>(File->getBinary());
  if (!Own || Elf->getEType() != ELF::ET_DYN)
    return std::nullopt;
  Expected<Interface> Found = read(*Own);
  if (!Found) {
    consumeError(Found.takeError());
    return std::nullopt;
  }
  return std::move(*Found);
}

} // namespace tpc
