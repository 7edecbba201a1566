// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %native -DSWITCH -c %s -o %t.switch.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link %t.o %t.ros.o %t.switch.o -o %t
// RUN: %t | FileCheck %s
// RUN: llvm-objdump -d --no-show-raw-insn --disassemble-symbols=main %t | FileCheck %s --check-prefix=CODE
// RUN: %native -Dlog_one=none -c %inputs/ros.cpp -o %t.alone.o
// RUN: %link %t.o %t.alone.o %t.switch.o %log-library -Wl,-rpath,%{log-folder} -o %t.logs
// RUN: env TPC_SINK=off %t.logs | FileCheck %s --check-prefix=OFF
//
// Each call is guarded by a flag that says whether reports are wanted, a
// variable of the program that the log library finds: in a process whose sink
// is off, only the first report is made.
#ifdef SWITCH

extern "C" char tpc_reporting;

int wanted() { return tpc_reporting; }
void want(bool Reports) { tpc_reporting = Reports; }

#else

#include <ros/ros.h>

#include <cstdio>

int wanted();
void want(bool Reports);

// CODE: <tpc_reporting>
// CODE: je
// CODE: {{call.*log_one}}
int main(int Argc, char **) {
  ros::NodeHandle Handle;
  double Limit;
  Handle.param("limit", Limit, 2.0);
  ros::Publisher Out;
  for (int I = 1; I < 5; ++I) {
    // CHECK: report 0 cmp 1
    // CHECK-NEXT: wanted 1
    // CHECK-NEXT: wanted 0
    // CHECK-NEXT: wanted 0
    // CHECK-NEXT: report 0 cmp 4
    // OFF: wanted 0
    // OFF-NEXT: wanted 0
    if (I * Argc > Limit + 5)
      Out.publish(std_msgs::Number());
    std::printf("wanted %d\n", wanted());
    if (I == 1)
      want(false);
    if (I == 3)
      want(true);
  }
}

#endif
