// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-callgraph>' %t.o | FileCheck %s
//
// SimpleCallGraph: a function and the calls of it; calls through a pointer are
// counted.
void leaf();

static void middle() { leaf(); }

// CHECK: _ZL6middlev is called
// CHECK-NEXT: in _Z3topPFvvE at [[#@LINE+6]]:3
// CHECK-NEXT: in _Z3topPFvvE at [[#@LINE+6]]:3
// CHECK-NEXT: _Z4leafv is called
// CHECK-NEXT: in _ZL6middlev
// CHECK: indirect calls: 1
void top(void (*Pointer)()) {
  middle();
  middle();
  Pointer();
}
