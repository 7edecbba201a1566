//===- ReadNames.cpp ------------------------------------------------------===//
#include "ReadNames.h"

#include "LogOne.h"
#include "Modes.h"
#include "RclState.h"
#include "Ros.h"
#include "Runtime.h"
#include "Threads.h"

#include <algorithm>
#include <iterator>
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

/// Gives the node of \p S, which has the evaluations of \p Object, if it is not
/// the one that the process is named after.
void ReadNames::tellNode(Site &S, const void *Object) {
  const std::string *Node = Nodes.of(Object);
  const char *Known = S.Node.load(std::memory_order_relaxed);
  if (!Node || *Node == (Known ? Known : rosNodeName()))
    return;
  S.Node.store(Node->c_str(), std::memory_order_release);
  if (!keep(S.Key + ",node:" + *Node, ObjectCount))
    warnOfObjects();
}

/// The same for the objects in these bytes, of which more is known now.
void ReadNames::tellNodes(const void *Object, uint64_t Size) {
  const auto Begin = reinterpret_cast<uintptr_t>(Object);
  const uintptr_t End = Begin + std::max<uint64_t>(Size, 1);
  for (auto &[S, Address] : Compared)
    if (Begin <= Address && Address < End)
      tellNode(*S, reinterpret_cast<const void *>(Address));
}

void ReadNames::add(const char *Key, const std::string &Name,
                    const void *Object, uint64_t Size,
                    const std::string &Node) {
  std::lock_guard<std::mutex> Guard(Lock);
  if (Object && !Node.empty()) {
    Nodes.add(Node, Object, Size);
    tellNodes(Object, Size);
  }
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
  for (auto &[S, Address] : Compared)
    tell(S->Key, Objects[Address]);
  for (const Reader &Each : Readers)
    tellOf(Each);
}

void ReadNames::addObject(Site &S, const void *Object) {
  std::lock_guard<std::mutex> Guard(Lock);
  auto Address = reinterpret_cast<uintptr_t>(Object);
  auto [At, IsNew] = Objects.try_emplace(Address, LastObject + 1);
  LastObject += IsNew;
  Compared.emplace_back(&S, Address);
  tell(S.Key, At->second);
  tellNode(S, Object);
  if (!IsNew)
    return;
  for (const Reader &R : Readers) {
    if (R.Begin > Address)
      break;
    if (Address < R.End)
      tell(*R.Name, At->second);
  }
}

void ReadNames::addNode(const std::string &Node, const void *Object,
                        uint64_t Size) {
  const auto Begin = reinterpret_cast<uintptr_t>(Object);
  const uintptr_t End = Begin + std::max<uint64_t>(Size, 1);
  bool IsOther;
  {
    std::lock_guard<std::mutex> Guard(Lock);
    IsOther = Nodes.replace(Node, Object, Size);
    if (IsOther)
      forget(Begin, End);
    else
      tellNodes(Object, Size);
  }
  // Not while Lock is held: a fork takes these two the other way round.
  if (IsOther && TheSites)
    sites().forget(Begin, End);
}

/// The objects in these bytes are gone.
void ReadNames::forget(uintptr_t Begin, uintptr_t End) {
  Objects.erase(Objects.lower_bound(Begin), Objects.lower_bound(End));
  Compared.erase(std::remove_if(Compared.begin(), Compared.end(),
                                [&](const auto &One) {
                                  return Begin <= One.second &&
                                         One.second < End;
                                }),
                 Compared.end());
  for (auto At = Readers.begin(); At != Readers.end();)
    At = Begin <= At->Begin && At->Begin < End ? Readers.erase(At)
                                               : std::next(At);
}

std::string ReadNames::nodeOf(const void *Object) {
  std::lock_guard<std::mutex> Guard(Lock);
  const std::string *Node = Object ? Nodes.of(Object) : nullptr;
  return Node ? *Node : "";
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

/// What instrumented code passes as a name: a C string, or a std::string.
static std::string textOf(const void *Name, bool IsText) {
  return IsText ? std::string(static_cast<const char *>(Name))
                : *static_cast<const std::string *>(Name);
}

void log_node(const char *node, const void *object,
              unsigned long size) noexcept {
  try {
    Thread *T = ThisThread ? ThisThread : makeThread();
    ReportMark Mark(*T);
    if (!Mark || !node || !*node || !object)
      return;
    RclState::of().noteName(node);
    ReadNames::all().addNode(node, object, size);
  } catch (...) {
    // A name that cannot be reported is not worth a node.
  }
}

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
    RclState::of().noteName(node);
    const std::string Node = node;
    ReadNames::all().add(key, Node + "/" + textOf(name, text), object, size,
                         Node);
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
    const std::string Name = textOf(name, text);
    // With ROS 2 the handle belongs to a node, or is one.
    const std::string Node = ReadNames::all().nodeOf(handle);
    const std::string Full =
        Node.empty() ? resolveName(handle, Name) : Node + "/" + Name;
    if (!Full.empty())
      ReadNames::all().add(key, Full, object, size, Node);
  } catch (...) {
    // A name that cannot be reported is not worth a node.
  }
}
