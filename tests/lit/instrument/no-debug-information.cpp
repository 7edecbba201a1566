// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -g0 -O2 %inputs/node.cpp -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t
// RUN: %t | FileCheck %s --implicit-check-not=report
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
//
// Without debug information there are no places: nothing is reported, the
// comparisons are counted, and the program is linked.
// CHECK: published out 3
// JSON: "kind": "without_debug_info",
// JSON-NEXT: "lineno": 0,
// JSON: "comparisons": 0,
// JSON: "without_debug_info": 3
