//===- Ring.cpp -----------------------------------------------------------===//
#include "Ring.h"

#include "Clock.h"
#include "Edges.h"
#include "LogFile.h"
#include "Modes.h"
#include "Threads.h"

#include <algorithm>
#include <sys/stat.h>
#include <unistd.h>

namespace tpc {

bool Ring::makeRoom(const Config &C, LogFile *Now) {
  const uint64_t Budget = C.RingBudgetMiB << 20;
  const uint64_t Present = Now ? Now->diskBytes() : 0;
  while (size().second + Present + C.segmentBytes() > Budget && removeOldest())
    ;
  // The next file may grow to the whole budget.
  return Files.empty() || size().second + Present <= Budget;
}

LogFile *Ring::next(const Config &C, LogFile *Now, std::string &Why) {
  if (!makeRoom(C, Now)) {
    Why = Files.front().Path +
          ": a thread does not finish a report to this file, so the file "
          "cannot be removed";
    return nullptr;
  }
  if (!Name.Began)
    Name.Began = Clock::real() / 1'000'000'000;
  LogFile *File = LogFile::open(C, &Name, Why);
  while (!File && removeOldest())
    File = LogFile::open(C, &Name, Why);
  if (!File)
    return nullptr;
  if (Now)
    File->goOnFrom(*Now);
  Began = Clock::steady();
  return File;
}

int64_t Ring::heldSince() const { return Files.front().End; }

int64_t Ring::dueAt(const Config &C) const {
  return Began + static_cast<int64_t>(C.RingNs / Config::Segments);
}

bool Ring::isDue(const Config &C, LogFile &Now, int64_t Steady) const {
  // The helper is woken when half of the last extent is given out.
  constexpr uint64_t Half = 1U << 19;
  return Now.isStopped() || Steady >= dueAt(C) ||
         Now.usedBytes() + Half >= C.segmentBytes();
}

void Ring::leave(LogFile &Old, int64_t Steady) {
  Former F{Old.path(), Old.identity(), Old.diskBytes(), Steady, &Old, false,
           {}};
  publishToThreads();
  for (Thread *T : allThreads())
    if (uint32_t Seen = T->Inside.load(std::memory_order_acquire);
        (Seen & 1) && T != ThisThread)
      F.Inside.emplace_back(T, Seen);
  Files.push_back(std::move(F));
}

/// Whether no thread is inside a report any more that it began before.
bool Ring::isLeft(Former &F) {
  auto HasGoneOn = [](const std::pair<Thread *, uint32_t> &Was) {
    return Was.first->Inside.load(std::memory_order_acquire) != Was.second;
  };
  F.Inside.erase(std::remove_if(F.Inside.begin(), F.Inside.end(), HasGoneOn),
                 F.Inside.end());
  return F.Inside.empty();
}

void Ring::settle(const Config &C, int64_t Steady) {
  for (Former &F : Files) {
    if (!F.File || !isLeft(F))
      continue;
    if (!F.IsClosed) {
      F.File->close();
      F.IsClosed = true;
      // While it is mapped, no other file has its number.
      struct stat Its;
      if (!lstat(F.Path.c_str(), &Its) &&
          std::make_pair(Its.st_dev, Its.st_ino) == F.Identity)
        F.Bytes = static_cast<uint64_t>(Its.st_size);
    }
    if (!holdsTouchedSlots(*F.File)) {
      release(F.File);
      F.File = nullptr;
    }
  }
  while (!Files.empty() &&
         Files.front().End + static_cast<int64_t>(C.RingNs) < Steady &&
         removeOldest())
    ;
  deleteUnknown();
}

/// Removes the name of the oldest file; false if there is none, or if it may
/// still be written.
bool Ring::removeOldest() {
  if (Files.empty() || !Files.front().IsClosed)
    return false;
  Former &F = Files.front();
  struct stat Its;
  if (!lstat(F.Path.c_str(), &Its) &&
      std::make_pair(Its.st_dev, Its.st_ino) == F.Identity &&
      static_cast<uint64_t>(Its.st_size) == F.Bytes)
    unlink(F.Path.c_str());
  if (F.File)
    release(F.File);
  Files.erase(Files.begin());
  return true;
}

/// Nobody is inside of \p File any more.
void Ring::release(LogFile *File) {
  if (holdsTouchedSlots(*File))
    return; // A thread is stuck in an old period: the memory stays.
  File->unmap();
  for (uint32_t Number = 1; Number <= sites().size(); ++Number) {
    Site &S = sites()[Number];
    const LogFile *Known = File;
    S.WrittenTo.compare_exchange_strong(Known, nullptr);
    Known = File;
    S.StatedIn.compare_exchange_strong(Known, nullptr);
  }
  Unmapped.push_back(File);
}

/// A thread knows a file by its address until its next report.
void Ring::deleteUnknown() {
  if (Unmapped.empty())
    return;
  std::vector<Thread *> Threads = allThreads();
  auto IsKnown = [&](LogFile *File) {
    return std::any_of(Threads.begin(), Threads.end(), [&](Thread *T) {
      return T->File.load(std::memory_order_relaxed) == File ||
             T->PairsHome.load(std::memory_order_relaxed) == File;
    });
  };
  auto Known = std::partition(Unmapped.begin(), Unmapped.end(), IsKnown);
  std::for_each(Known, Unmapped.end(), [](LogFile *File) { delete File; });
  Unmapped.erase(Known, Unmapped.end());
}

void Ring::end() {
  for (Former &F : Files)
    if (F.File && !F.IsClosed)
      F.File->close();
}

void Ring::forget() {
  Files.clear();
  Unmapped.clear();
  Name = {};
}

std::pair<size_t, uint64_t> Ring::size() const {
  uint64_t Bytes = 0;
  for (const Former &F : Files)
    Bytes += F.Bytes;
  return {Files.size(), Bytes};
}

} // namespace tpc
