//===- ReadNames.cpp ------------------------------------------------------===//
#include "ReadNames.h"

#include "LogOne.h"
#include "Runtime.h"
#include "Threads.h"

#include <algorithm>
#include <utility>

namespace tpc {

ReadNames &ReadNames::all() {
  static auto *Only = new ReadNames;
  return *Only;
}

/// \p Text among what is given to sinks; null if that has \p Count, which is
/// counted, of its kind already.
const std::string *ReadNames::keep(std::string Text, size_t &Count) {
  if (auto Found = Known.find(Text); Found != Known.end())
    return &*Found;
  if (Count == Most)
    return nullptr;
  ++Count;
  const std::string *Kept = &*Known.insert(std::move(Text)).first;
  InOrder.push_back(Kept);
  if (!Any.exchange(true))
    wakeHelper();
  return Kept;
}

/// Gives the number of the object of a name or key.
void ReadNames::tell(const std::string &Of, uint32_t Object) {
  if (TellsObjects && !keep(Of + ",of:" + std::to_string(Object), ObjectCount))
    warnOfObjects();
}

void ReadNames::warnOfObjects() {
  if (!std::exchange(IsFullOfObjects, true))
    warn("more than " + std::to_string(Most) +
         " times an object of this process reads a parameter or evaluates a "
         "comparison: of further ones it is not reported which object it was");
}

/// Gives the objects in which \p R has read its name.
void ReadNames::tellOf(const Reader &R) {
  for (auto At = Objects.lower_bound(R.Begin);
       At != Objects.end() && At->first < R.End; ++At)
    tell(*R.Name, At->second);
}

void ReadNames::add(const char *Key, const std::string &Name,
                    const void *Object, uint64_t Size) {
  std::lock_guard<std::mutex> Guard(Lock);
  const std::string *Kept = keep(std::string(Key) + "," + Name, NameCount);
  if (!Kept && !IsFull) {
    IsFull = true;
    warn("this process reads more than " + std::to_string(Most) +
         " parameters; the names of further ones are not reported");
  }
  if (!Kept || !Object)
    return;
  auto Begin = reinterpret_cast<uintptr_t>(Object);
  Reader R{Begin, Begin + std::max<uint64_t>(Size, 1), Kept};
  if (Readers.count(R))
    return;
  bool IsFirst = FirstNames.try_emplace(Key, Kept).first->second == Kept;
  if (Readers.size() == Most) {
    if (TellsObjects || !IsFirst)
      warnOfObjects();
    return;
  }
  Readers.insert(R);
  if (TellsObjects || IsFirst)
    return tellOf(R);
  TellsObjects = true;
  for (auto &[Evaluated, Number] : Compared)
    tell(Evaluated, Number);
  for (const Reader &Each : Readers)
    tellOf(Each);
}

void ReadNames::addObject(const std::string &Key, const void *Object) {
  std::lock_guard<std::mutex> Guard(Lock);
  auto Address = reinterpret_cast<uintptr_t>(Object);
  auto [At, IsNew] =
      Objects.try_emplace(Address, static_cast<uint32_t>(Objects.size() + 1));
  Compared.emplace_back(Key, At->second);
  tell(Key, At->second);
  if (!IsNew)
    return;
  for (const Reader &R : Readers) {
    if (R.Begin > Address)
      break;
    if (Address < R.End)
      tell(*R.Name, At->second);
  }
}

void ReadNames::startAgain() {
  std::lock_guard<std::mutex> Guard(Lock);
  Given = nullptr;
}

void ReadNames::give(Sink &To, int64_t Now) {
  std::lock_guard<std::mutex> Guard(Lock);
  bool IsNew = Given != &To;
  if (IsNew || (To.forgets() && Now - AllGivenAt >= AgainNs)) {
    AgainNs = IsNew ? FirstAgainNs : std::min(2 * AgainNs, LastAgainNs);
    Given = &To;
    GivenCount = 0;
    AllGivenAt = Now;
  }
  for (; GivenCount < InOrder.size(); ++GivenCount)
    To.take(ReadName{*InOrder[GivenCount]});
}

} // namespace tpc

using namespace tpc;

void log_read(char *key, const void *handle, const void *name,
              bool text) noexcept {
  log_read_of(key, handle, name, text, nullptr, 0);
}

void log_read_in(char *key, const char *node, const void *name, bool text,
                 const void *object, unsigned long size) noexcept {
  try {
    Thread *T = ThisThread ? ThisThread : makeThread();
    ReportMark Mark(*T);
    if (!Mark || !node || !*node)
      return;
    std::string Full = node;
    Full += '/';
    if (text)
      Full += static_cast<const char *>(name);
    else
      Full += *static_cast<const std::string *>(name);
    ReadNames::all().add(key, Full, object, size);
  } catch (...) {
    // A name that cannot be reported is not worth a node.
  }
}

void log_read_of(char *key, const void *handle, const void *name, bool text,
                 const void *object, unsigned long size) noexcept {
  try {
    Thread *T = ThisThread ? ThisThread : makeThread();
    ReportMark Mark(*T);
    if (!Mark)
      return;
    const std::string &Name = text
                                  ? std::string(static_cast<const char *>(name))
                                  : *static_cast<const std::string *>(name);
    if (std::string Full = resolveName(handle, Name); !Full.empty())
      ReadNames::all().add(key, Full, object, size);
  } catch (...) {
    // A name that cannot be reported is not worth a node.
  }
}
