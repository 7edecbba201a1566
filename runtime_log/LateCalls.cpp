//===- LateCalls.cpp ------------------------------------------------------===//
#include "LateCalls.h"

#include <atomic>
#include <cstdint>
#include <cstring>
#include <elf.h>
#include <link.h>
#include <string_view>
#include <sys/mman.h>
#include <unistd.h>

namespace tpc {
namespace {

#if defined(__x86_64__)
constexpr uint64_t JumpSlot = R_X86_64_JUMP_SLOT, Data = R_X86_64_GLOB_DAT;
#elif defined(__aarch64__)
constexpr uint64_t JumpSlot = R_AARCH64_JUMP_SLOT, Data = R_AARCH64_GLOB_DAT;
#endif

struct Wanted {
  const LateCall *Calls;
  size_t Count;
  size_t Replaced = 0;
};

#if defined(__x86_64__) || defined(__aarch64__)

/// The parts of a loaded library that say what it calls.
struct Tables {
  const ElfW(Sym) *Symbols = nullptr;
  const char *Names = nullptr;
  struct {
    const ElfW(Rela) *Begin = nullptr;
    size_t Bytes = 0;
  } Calls, Others;
  /// Read-only once the linker is done.
  uintptr_t FixedBegin = 0, FixedEnd = 0;
};

Tables tablesOf(const dl_phdr_info &Of) {
  Tables T;
  const ElfW(Dyn) *Entry = nullptr;
  for (int I = 0; I < Of.dlpi_phnum; ++I) {
    const ElfW(Phdr) &P = Of.dlpi_phdr[I];
    if (P.p_type == PT_DYNAMIC)
      Entry = reinterpret_cast<const ElfW(Dyn) *>(Of.dlpi_addr + P.p_vaddr);
    if (P.p_type == PT_GNU_RELRO) {
      T.FixedBegin = Of.dlpi_addr + P.p_vaddr;
      T.FixedEnd = T.FixedBegin + P.p_memsz;
    }
  }
  // The linker has made addresses of most of them, but not everywhere.
  const auto At = [&](const ElfW(Dyn) * E) {
    return E->d_un.d_ptr < Of.dlpi_addr ? Of.dlpi_addr + E->d_un.d_ptr
                                        : E->d_un.d_ptr;
  };
  for (; Entry && Entry->d_tag != DT_NULL; ++Entry) {
    if (Entry->d_tag == DT_SYMTAB)
      T.Symbols = reinterpret_cast<const ElfW(Sym) *>(At(Entry));
    else if (Entry->d_tag == DT_STRTAB)
      T.Names = reinterpret_cast<const char *>(At(Entry));
    else if (Entry->d_tag == DT_JMPREL)
      T.Calls.Begin = reinterpret_cast<const ElfW(Rela) *>(At(Entry));
    else if (Entry->d_tag == DT_PLTRELSZ)
      T.Calls.Bytes = Entry->d_un.d_val;
    else if (Entry->d_tag == DT_RELA)
      T.Others.Begin = reinterpret_cast<const ElfW(Rela) *>(At(Entry));
    else if (Entry->d_tag == DT_RELASZ)
      T.Others.Bytes = Entry->d_un.d_val;
  }
  return T;
}

/// Writes an entry of the table, which may be in pages that are read-only.
bool replace(const Tables &T, uintptr_t Entry, void *By) {
  const uintptr_t Page = Entry & ~(static_cast<uintptr_t>(getpagesize()) - 1);
  const auto Bytes = static_cast<size_t>(getpagesize());
  const bool IsFixed = T.FixedBegin <= Entry && Entry < T.FixedEnd;
  if (IsFixed &&
      mprotect(reinterpret_cast<void *>(Page), Bytes, PROT_READ | PROT_WRITE))
    return false;
  // Another thread may call by it now.
  __atomic_store_n(reinterpret_cast<void **>(Entry), By, __ATOMIC_RELEASE);
  // The last page of those may have writable data behind them.
  if (IsFixed && Page + Bytes <= T.FixedEnd)
    mprotect(reinterpret_cast<void *>(Page), Bytes, PROT_READ);
  return true;
}

int takeFrom(dl_phdr_info *Info, size_t, void *To) {
  auto &W = *static_cast<Wanted *>(To);
  const std::string_view Path = Info->dlpi_name ? Info->dlpi_name : "";
  // The log library and its backends call rcl itself.
  if (Path.find("/libtpc_log") != std::string_view::npos)
    return 0;
  const Tables T = tablesOf(*Info);
  if (!T.Symbols || !T.Names)
    return 0;
  for (const auto &Part : {T.Calls, T.Others}) {
    const size_t Count = Part.Begin ? Part.Bytes / sizeof(ElfW(Rela)) : 0;
    for (size_t I = 0; I < Count; ++I) {
      const ElfW(Rela) &R = Part.Begin[I];
      const uint64_t Kind = ELF64_R_TYPE(R.r_info);
      if (Kind != JumpSlot && Kind != Data)
        continue;
      const ElfW(Sym) &S = T.Symbols[ELF64_R_SYM(R.r_info)];
      if (S.st_shndx != SHN_UNDEF)
        continue;
      for (size_t C = 0; C < W.Count; ++C)
        if (!std::strcmp(T.Names + S.st_name, W.Calls[C].Name))
          W.Replaced +=
              replace(T, Info->dlpi_addr + R.r_offset, W.Calls[C].Ours);
    }
  }
  return 0;
}

#else

int takeFrom(dl_phdr_info *, size_t, void *) { return 0; }

#endif

} // namespace

size_t takeCalls(const LateCall *Calls, size_t Count) {
  Wanted W{Calls, Count};
  dl_iterate_phdr(takeFrom, &W);
  return W.Replaced;
}

} // namespace tpc
