// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %inputs/node.cpp -o %t.o
// RUN: %link -O0 -Wl,-mllvm,-tpc-inject-failure=time -Wl,-mllvm,-tpc-max-seconds=1 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t | FileCheck %s
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
//
// An analysis that exceeds its time keeps what its stages find in their shares
// of it: here everything, since the time is spent before the first stage. One
// warning says what to do, and the file why comparisons may be missing.
// WARN: warning: node: the analysis does not fit into 1 s (-tpc-max-seconds raises the limit, TPC_MAX_SECONDS in CMake); the comparisons found so far will report, others may be missing
// WARN-NOT: {{.}}
// CHECK: report
// CHECK: published out 3
// JSON-DAG: "comparisons": 3,
// JSON-DAG: "functions": {{[1-9]}}
// JSON-DAG: "failure": null
// JSON-DAG: "incomplete": "the analysis does not fit into 1 s
// JSON-DAG: "status": "ok"
