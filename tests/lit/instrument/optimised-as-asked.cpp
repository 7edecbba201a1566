// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link %t.2.o %t.ros.o -o %t.2
// RUN: llvm-objdump -d --no-show-raw-insn --disassemble-symbols=main %t.2 | FileCheck %s --check-prefix=FAST
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link %t.0.o %t.ros.o -o %t.0
// RUN: llvm-objdump -d --no-show-raw-insn --disassemble-symbols=main %t.0 | FileCheck %s --check-prefix=SLOW
//
// The program is optimised as requested: at -O2 the helper is inlined and its
// loop becomes a formula, at -O0 it is called. The level is that of the
// compiler, not of the link.
#include <ros/ros.h>

static int addUpTo(int N) {
  int S = 0;
  for (int I = 0; I < N; ++I)
    S += I;
  return S;
}

// FAST-NOT: {{call.*addUpTo}}
// FAST: {{call.*log_one}}
// FAST-NOT: {{call.*addUpTo}}
// SLOW: {{call.*addUpTo}}
// SLOW: {{call.*log_one}}
int main(int Argc, char **) {
  ros::NodeHandle Handle;
  int Limit;
  Handle.param("limit", Limit, 3);
  ros::Publisher Out;
  if (addUpTo(Argc) < Limit)
    Out.publish(std_msgs::Number());
}
