// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %inputs/node.cpp -o %t.0.o
// RUN: %link -O0 -Wl,-mllvm,-tpc-link-unit=node %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O1 %inputs/node.cpp -o %t.1.o
// RUN: %link -O1 -Wl,-mllvm,-tpc-link-unit=node %t.1.o %t.ros.o -o %t.1
// RUN: %t.1 | FileCheck %s
// RUN: %compile -O2 %inputs/node.cpp -o %t.2.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
// RUN: %compile -O3 %inputs/node.cpp -o %t.3.o
// RUN: %link -O3 -Wl,-mllvm,-tpc-link-unit=node %t.3.o %t.ros.o -o %t.3
// RUN: %t.3 | FileCheck %s
//
// The instrumented program reports before each predicate and publishes what it
// published before, at every level. Values 0 to 6 are compared with a limit of
// 2.5; the first three above it (3, 4 and 5) are published. An operand that &&
// does not evaluate is not reported.
// CHECK: report 0 cmp 0 thresh 0 res 0
// CHECK-NEXT: report 0 cmp 0 thresh 2.5 res 0
// CHECK-NEXT: report 0 cmp 0 thresh 0 res 0
// CHECK-NEXT: report 0 cmp 1 thresh 2.5 res 0
// CHECK-NEXT: report 0 cmp 0 thresh 0 res 0
// CHECK-NEXT: report 0 cmp 2 thresh 2.5 res 0
// CHECK-NEXT: report 0 cmp 0 thresh 0 res 0
// CHECK-NEXT: report 1 cmp 3 thresh 2.5 res 1
// CHECK-NEXT: report 1 cmp 0 thresh 3 res 1
// CHECK-NEXT: published out 3
// CHECK: published out 4
// CHECK: published out 5
// CHECK-NEXT: report 0 cmp 0 thresh 0 res 0
// CHECK-NEXT: report 1 cmp 6 thresh 2.5 res 1
// CHECK-NEXT: report 0 cmp 3 thresh 3 res 0 key {{....}}
// CHECK-NOT: {{.}}
