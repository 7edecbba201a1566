// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %inputs/node.cpp -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-inject-failure -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t | FileCheck %s --implicit-check-not=report
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
//
// A crash inside the analysis costs one warning and a record, not the build:
// the program is linked without reports.
// WARN: warning: node: the analysis crashed; this link unit is left as it was
// WARN-NOT: {{.}}
// CHECK: published out 3
// JSON-DAG: "status": "failed"
// JSON-DAG: "failure": "the analysis crashed"
// JSON-DAG: "comparisons": []
