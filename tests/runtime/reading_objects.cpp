// Objects that read a parameter of their own and compare it, as instrumented
// code reports them: reading_objects OBJECTS NAMES. NAMES differ, in turns.
#include "LogOne.h"

#include <cstdint>
#include <ros/init.h>
#include <string>
#include <vector>

int main(int Count, char **Arguments) {
  // The names are resolved for this node; no master is asked.
  ros::init(Count, Arguments, "node");
  std::vector<uint64_t> Objects(std::stoul(Arguments[1]));
  size_t Names = std::stoul(Arguments[2]);
  char ReadKey[] = "0e6f4f0a-52f7-5f59-8b0e-0d44a8e9f001";
  char Key[] = "0e6f4f0a-52f7-5f59-8b0e-0d44a8e9f002";
  for (size_t I = 0; I < Objects.size(); ++I) {
    std::string Name = "limit" + std::to_string(I % Names);
    log_read_of(ReadKey, nullptr, Name.c_str(), true, &Objects[I],
                sizeof(Objects[I]));
    log_one_of(Key, true, 1, 2, true, &Objects[I]);
  }
}
