// Blocks of comparisons that are reported, timed together, with a break between
// blocks: prints the nanoseconds of a report in each block, one a line.
//
// Ring BLOCKS COUNT GAP_US

#include <tpc/LogOne.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

int main(int Count, char **Words) {
  if (Count != 4)
    return 2;
  const long Blocks = std::atol(Words[1]), Reports = std::atol(Words[2]);
  const auto Gap = std::chrono::microseconds(std::atol(Words[3]));
  std::vector<std::string> Keys;
  for (int I = 0; I < 16; ++I) {
    char Text[40];
    std::snprintf(Text, sizeof(Text), "%08d-0000-4000-8000-000000000000", I);
    Keys.emplace_back(Text);
  }
  using Clock = std::chrono::steady_clock;
  for (long Block = 0; Block < Blocks; ++Block) {
    const auto Begin = Clock::now();
    for (long I = 0; I < Reports; ++I)
      log_one(Keys[I % Keys.size()].data(), true, static_cast<double>(I), 0.5,
              true);
    const std::chrono::duration<double, std::nano> Took = Clock::now() - Begin;
    std::printf("%.3f\n", Took.count() / static_cast<double>(Reports));
    std::this_thread::sleep_for(Gap);
  }
}
