// RUN: %compile -O0 %s -o %t.0.o
// RUN: %compile -O2 %s -o %t.2.o
// RUN: llvm-dis %t.0.o -o - | FileCheck %s --check-prefixes=CHECK,O0
// RUN: llvm-dis %t.2.o -o - | FileCheck %s --check-prefixes=CHECK,O2
//
// None of clang's own passes runs at any level, and the attributes that the
// level sets for the passes at the link are kept.
// CHECK-LABEL: define {{.*}}@square
// CHECK: alloca i32
// CHECK: %[[#V:]] = load i32
// CHECK: mul nsw i32
// O0: attributes #0 = { {{.*}}noinline {{.*}}optnone
// O2-NOT: optnone
// O2: !{!"Simple C++ TBAA"}
extern "C" int square(int V) { return V * V; }
