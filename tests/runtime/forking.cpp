//===- forking.cpp - Forks while another thread reports -------------------===//
//
// forking KEYS FORKS: so many keys, so that the helper thread of the log
// library, which collects what they reported, works nearly all of the time.
//
//===----------------------------------------------------------------------===//
#include "LogOne.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

static std::vector<std::string> Keys;

static void report() {
  for (std::string &Key : Keys)
    log_one(Key.data(), true, 1, 2, false);
}

int main(int, char **Words) {
  for (int I = 0, Count = std::atoi(Words[1]); I < Count; ++I) {
    char Text[48];
    std::snprintf(Text, sizeof(Text), "%08x-0000-5000-8000-000000000000", I);
    Keys.push_back(Text);
  }
  report();
  std::thread([] {
    for (;;) {
      report();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }).detach();
  for (int I = 0, Count = std::atoi(Words[2]); I < Count; ++I) {
    const pid_t Child = fork();
    if (!Child)
      _exit(0);
    int Status = 1;
    if (Child < 0 || waitpid(Child, &Status, 0) != Child || Status)
      return 1;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  _exit(0);
}
