//===- Budget.cpp ---------------------------------------------------------===//
#include "support/Budget.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <unistd.h>

namespace tpc {

thread_local Budget *Budget::Current = nullptr;

/// Processor time of this thread.
static double seconds() {
  timespec T{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &T);
  return static_cast<double>(T.tv_sec) + static_cast<double>(T.tv_nsec) * 1e-9;
}

/// Memory that the process uses, in MiB; 0 without /proc.
static double memory() {
  double Pages = 0;
  if (std::FILE *File = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(File, "%*s %lf", &Pages) != 1)
      Pages = 0;
    std::fclose(File);
  }
  return Pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

Budget::Budget(unsigned MaxSeconds, unsigned MaxMemory)
    : Outer(Current), MaxSeconds(MaxSeconds), MaxMemory(MaxMemory),
      SecondsBefore(seconds()), MemoryBefore(memory()) {
  Current = this;
}

Budget::~Budget() { Current = Outer; }

double Budget::usedTime() const {
  return MaxSeconds ? (seconds() - SecondsBefore) / MaxSeconds : 0;
}

double Budget::usedMemory() const {
  return MaxMemory ? (memory() - MemoryBefore) / MaxMemory : 0;
}

double Budget::used() const { return std::max(usedTime(), usedMemory()); }

/// The clock is cheap to read, the memory is not.
static constexpr unsigned LooksAtMemory = 8;

bool Budget::look() {
  Spent = usedTime() > End ||
          (Asked / LookEvery % LooksAtMemory == 0 && usedMemory() > End);
  if (Spent)
    leaveOut();
  return Spent;
}

void Budget::leaveOut() {
  if (!Why.empty())
    return;
  if (usedTime() >= usedMemory())
    Why = "the analysis does not fit into " + std::to_string(MaxSeconds) +
          " s (-tpc-max-seconds raises the limit, TPC_MAX_SECONDS in CMake)";
  else
    Why = "the analysis does not fit into " + std::to_string(MaxMemory) +
          " MiB (-tpc-max-memory raises the limit, TPC_MAX_MEMORY in CMake)";
}

Budget::Share::Share(double Fraction) {
  if (!Current)
    return;
  Before = Current->End;
  double Used = Current->used();
  Current->End = Used + std::max(Fraction * (Before - Used), 0.05);
  Current->Spent = false;
}

Budget::Share::~Share() {
  if (!Current)
    return;
  Current->End = Before;
  Current->Spent = false;
}

} // namespace tpc
