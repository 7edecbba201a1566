// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O3 %s -o %t.3.o
// RUN: %compile -O0 -DOTHER %s -o %t.0.o
// RUN: %link %t.3.o %t.0.o %t.ros.o -o %t
// RUN: llvm-objdump -d --no-show-raw-insn --disassemble-symbols=main,_Z5otheri %t | FileCheck %s
//
// If a link has files of several levels, those of -O0 are not optimised and the
// others are.
#include <ros/ros.h>

// CHECK-LABEL: <main>:
// CHECK-NOT: {{call.*sameM}}
// CHECK: _Z5otheri
// CHECK-NOT: {{call.*sameM}}
// CHECK-LABEL: <_Z5otheri>:
// CHECK: {{call.*sameO}}
#ifdef OTHER
static int sameO(int X) { return X + 1; }
int other(int X) { return sameO(X); }
#else
int other(int X);
static int sameM(int X) { return X + 2; }
int main(int Argc, char **) { return other(sameM(Argc)); }
#endif
