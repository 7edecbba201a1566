//===- Budget.cpp ---------------------------------------------------------===//
#include "support/Budget.h"

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

bool Budget::look() {
  if (MaxSeconds && seconds() - SecondsBefore > MaxSeconds)
    Why = "the analysis takes more than " + std::to_string(MaxSeconds) +
          " s (-tpc-max-seconds raises the limit, TPC_MAX_SECONDS in CMake)";
  else if (MaxMemory && memory() - MemoryBefore > MaxMemory)
    Why = "the analysis takes more than " + std::to_string(MaxMemory) +
          " MiB (-tpc-max-memory raises the limit, TPC_MAX_MEMORY in CMake)";
  return Spent = !Why.empty();
}

std::string Budget::why() {
  if (!Spent)
    look();
  return Why;
}

} // namespace tpc
