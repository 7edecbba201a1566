// RUN: %native -DHOST %s -o %t.host -ldl
// RUN: %native -fPIC -Dlog_one=none -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 -fPIC %s -o %t.o
// RUN: echo "{ global: run; tpc_reporting; local: *; };" > %t.map
// RUN: %link -shared -Wl,--version-script=%t.map -Wl,--undefined-version %t.o %t.ros.o %log-library -Wl,-rpath,%{log-folder} -o %t.so
// RUN: env TPC_SINK=file TPC_POLICY=edges TPC_FOLDER=%t.folder %t.host %t.so | FileCheck %s
// RUN: env TPC_SINK=off %t.host %t.so | FileCheck %s
//
// A plugin that reports can be unloaded and loaded again as without reports; the
// log library stays, because its helper thread may be running. (The version script
// keeps the replacement for roscpp in these tests apart from the real one.)
#ifdef HOST

#include <chrono>
#include <cstdio>
#include <dlfcn.h>
#include <thread>

int main(int, char **Words) {
  // CHECK: ran
  // CHECK-NEXT: gone
  // CHECK-NEXT: ran
  // CHECK-NEXT: gone
  for (int I = 0; I < 2; ++I) {
    void *Plugin = dlopen(Words[1], RTLD_NOW | RTLD_LOCAL);
    if (!Plugin)
      return std::puts(dlerror());
    reinterpret_cast<void (*)()>(dlsym(Plugin, "run"))();
    std::puts("ran");
    dlclose(Plugin);
    std::puts(dlopen(Words[1], RTLD_NOW | RTLD_NOLOAD) ? "there" : "gone");
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
  }
}

#else

#include <ros/ros.h>

extern "C" void run() {
  ros::NodeHandle Handle;
  double Limit;
  Handle.param("limit", Limit, 2.0);
  ros::Publisher Out;
  for (int I = 0; I < 3; ++I)
    if (I > Limit)
      Out.publish(std_msgs::Number());
}

#endif
