// RUN: %compile -O2 -fPIC %s -o %t.o
// RUN: llvm-dis %t.o -o - | FileCheck %s
// RUN: %link -shared %t.o -o %t.so
// RUN: llvm-nm -D %t.so | FileCheck %s --check-prefix=EXPORTED
//
// What clang writes is as the source has it. An inline function that nobody
// takes the address of is not exported for being in the file, as it would not
// be if it had gone into its callers there; one that somebody takes it of, an
// instantiation that is asked for, and the variables in functions are.
// CHECK-DAG: define linkonce_odr {{.*}} @_Z6calledi({{.*}}) unnamed_addr #
// CHECK-DAG: define linkonce_odr {{.*}} @_Z5takeni({{.*}}) #
// CHECK-DAG: define weak_odr {{.*}} @_Z9requestedIiET_S0_({{.*}}) #
// CHECK-DAG: call {{.*}} @_Z6calledi(
//
// EXPORTED-NOT: _Z6calledi
// EXPORTED-DAG: _Z5takeni
// EXPORTED-DAG: _Z9requestedIiET_S0_
// EXPORTED-DAG: _ZZ6callediE5Count
// EXPORTED-NOT: _Z6calledi

inline int called(int V) {
  static int Count;
  return V + ++Count;
}

inline int taken(int V) { return V * 3; }

template <typename T> T requested(T V) { return V - 1; }
template int requested<int>(int);

using Function = int (*)(int);
extern "C" Function use(int V) { return called(V) > 3 ? taken : nullptr; }
