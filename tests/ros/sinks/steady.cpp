// A node with a loop of 100 turns a second, for tests/ros/test_bad_input.py. In
// each turn it evaluates ten comparisons four times each, and it reads so many
// parameters in the first half of its turns. Says `ready` after the first turn
// and, when it ends, how long its turns took, in milliseconds:
// `turns=N median=MS longest=MS`.
//
// steady --seconds=S --names=N

#include <ros/ros.h>
#include <tpc/LogOne.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

using Clock = std::chrono::steady_clock;

static long option(int Count, char **Words, const char *Name, long Otherwise) {
  const std::string Start = std::string("--") + Name + "=";
  for (int I = 1; I < Count; ++I)
    if (!std::strncmp(Words[I], Start.c_str(), Start.size()))
      return std::atol(Words[I] + Start.size());
  return Otherwise;
}

static std::string key(long Number) {
  char Text[40];
  std::snprintf(Text, sizeof(Text), "%08ld-0000-4000-8000-000000000000",
                Number);
  return Text;
}

int main(int Count, char **Words) {
  constexpr long Sites = 10, EachTurn = 4;
  const long Turns = 100 * option(Count, Words, "seconds", 3);
  const long Names = option(Count, Words, "names", 1);
  ros::init(Count, Words, "steady");
  ros::NodeHandle Node("~");
  ros::AsyncSpinner Spinner(1);
  Spinner.start();
  std::vector<std::string> Keys;
  for (long I = 0; I < Sites; ++I)
    Keys.push_back(key(I));
  std::vector<double> Took;
  std::string ReadKey = key(Sites);
  long Read = 0;
  auto Next = Clock::now(), Before = Next;
  for (long Turn = 0; Turn < Turns && ros::ok(); ++Turn) {
    for (long I = 0; I < Sites * EachTurn; ++I)
      log_one(Keys[I % Sites].data(), Turn / 50 % 2, 0.25 * double(Turn), 0.5,
              Turn / 50 % 2);
    // All names within the first half of the turns.
    for (; Read < Names && Read * Turns < 2 * (Turn + 1) * Names; ++Read) {
      const std::string Name = "part" + std::to_string(Read) + "/limit";
      log_read(ReadKey.data(), &Node, &Name, false);
    }
    if (Turn == 0)
      std::puts("ready"), std::fflush(stdout);
    Next += std::chrono::milliseconds(10);
    std::this_thread::sleep_until(Next);
    const auto Now = Clock::now();
    Took.push_back(
        std::chrono::duration<double, std::milli>(Now - Before).count());
    Before = Now;
  }
  std::sort(Took.begin(), Took.end());
  std::printf("turns=%zu median=%.2f longest=%.2f\n", Took.size(),
              Took[Took.size() / 2], Took.back());
  std::fflush(stdout);
  return 0;
}
