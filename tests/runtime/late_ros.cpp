//===- late_ros.cpp - ROS is loaded while the program reports -------------===//
//
// late_ros LIBRARY: reports 50 times before it loads the library, and 100 times
// after that, 10 ms apart.
//
//===----------------------------------------------------------------------===//
#include "LogOne.h"

#include <chrono>
#include <dlfcn.h>
#include <thread>

int main(int, char **Words) {
  static char Key[] = "00000000-0000-5000-8000-000000000000";
  for (int I = 0; I < 150; ++I) {
    if (I == 50 && !dlopen(Words[1], RTLD_NOW))
      return 1;
    log_one(Key, I % 2, I, 2, false);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return 0;
}
