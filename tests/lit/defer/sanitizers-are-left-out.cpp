// RUN: %compile -O1 -fsanitize=address %s -o - | llvm-dis -o - | FileCheck %s
// RUN: %compile -O1 -fsanitize=thread %s -o - | llvm-dis -o - | FileCheck %s
// RUN: %compile -O1 --coverage %s -o - | llvm-dis -o - | FileCheck %s
//
// What the compiler's own passes would add to the code is left out with them
// (tpc.cmake warns about it); the code is that of the source.
// CHECK-LABEL: define {{.*}}@first
// CHECK-NOT: sanitize_
// CHECK-NOT: call {{.*}}san_
// CHECK-NOT: gcov
// CHECK: ret i32
extern "C" int first(const int *V) { return V[0]; }
