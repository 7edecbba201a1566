// RUN: %compile -O2 -fPIC %s -o %t.o
// RUN: llvm-dis %t.o -o - | FileCheck %s
// RUN: %link -shared %t.o -o %t.so
// RUN: llvm-nm -D %t.so | FileCheck %s --check-prefix=EXPORTED
//
// An inline function of a system header whose address nobody takes is not
// exported merely because it is in the file: an optimised file would not
// contain it. These are exported: one whose address is taken, inline user
// functions (a template in a source file may have no other body) and variables
// inside functions.
// CHECK-DAG: define linkonce_odr {{.*}} @_ZSt3maxIiERKT_S2_S2_({{.*}}) unnamed_addr #
// CHECK-DAG: define linkonce_odr {{.*}} @_ZSt3minIiERKT_S2_S2_({{.*}}) #
// CHECK-DAG: define linkonce_odr {{.*}} @_Z6calledi({{.*}}) #
// CHECK-DAG: define weak_odr {{.*}} @_Z9requestedIiET_S0_({{.*}}) #
// CHECK-DAG: call {{.*}} @_ZSt3maxIiERKT_S2_S2_(
//
// EXPORTED-NOT: _ZSt3max
// EXPORTED-DAG: _ZSt3minIiERKT_S2_S2_
// EXPORTED-DAG: _Z6calledi
// EXPORTED-DAG: _Z9requestedIiET_S0_
// EXPORTED-DAG: _ZZ6callediE5Count
// EXPORTED-NOT: _ZSt3max
#include <algorithm>

inline int called(int V) {
  static int Count;
  return V + ++Count;
}

template <typename T> T requested(T V) { return V - 1; }
template int requested<int>(int);

using Function = const int &(*)(const int &, const int &);
extern "C" Function use(int V) {
  Function Min = std::min<int>;
  return std::max(called(V), 2) > 3 ? Min : nullptr;
}
