//===- ReadNames.cpp ------------------------------------------------------===//
#include "ReadNames.h"

#include "LogOne.h"
#include "Runtime.h"
#include "Threads.h"

#include <algorithm>

namespace tpc {

ReadNames &ReadNames::all() {
  static auto *Only = new ReadNames;
  return *Only;
}

void ReadNames::add(const char *Key, const std::string &Name) {
  std::string Text = std::string(Key) + "," + Name;
  std::lock_guard<std::mutex> Guard(Lock);
  if (IsFull || Known.count(Text))
    return;
  IsFull = Known.size() == Most;
  if (IsFull) {
    warn("this process reads more than " + std::to_string(Most) +
         " parameters; the names of further ones are not reported");
    return;
  }
  InOrder.push_back(&*Known.insert(std::move(Text)).first);
  if (!Any.exchange(true))
    wakeHelper();
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
  try {
    Thread *T = ThisThread ? ThisThread : makeThread();
    ReportMark Mark(*T);
    if (!Mark)
      return;
    const std::string &Name = text
                                  ? std::string(static_cast<const char *>(name))
                                  : *static_cast<const std::string *>(name);
    if (std::string Full = resolveName(handle, Name); !Full.empty())
      ReadNames::all().add(key, Full);
  } catch (...) {
    // A name that cannot be reported is not worth a node.
  }
}
