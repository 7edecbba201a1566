// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-class-object-access>' %t.o | FileCheck %s
//
// ClassObjectAccess: loads and stores of a field, by its path from the class or
// the variable.
struct Inner {
  int A, B;
};
struct Outer {
  int X;
  Inner In;
};

Outer Global;

// CHECK-DAG: store [struct.Outer.1][struct.Inner.1] in _Z3setP5Outeri at [[#@LINE+1]]:
void set(Outer *O, int V) { O->In.B = V; }
// CHECK-DAG: load [struct.Inner.1] in _Z3getRK5Inner at [[#@LINE+1]]:
int get(const Inner &I) { return I.B; }
// CHECK-DAG: load @Global[struct.Outer.0] in _Z5firstv at [[#@LINE+1]]:
int first() { return Global.X; }
