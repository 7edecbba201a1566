// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %inputs/node.cpp -o %t.o
// RUN: %link -O0 -Wl,-mllvm,-tpc-inject-failure=time -Wl,-mllvm,-tpc-max-seconds=1 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t | FileCheck %s --implicit-check-not=report
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
//
// An analysis that exceeds its time costs one warning, which says what to do,
// and an entry in the file with the counts so far. The program is linked
// without reports.
// WARN: warning: node: the analysis takes more than 1 s (-tpc-max-seconds raises the limit, TPC_MAX_SECONDS in CMake); this link unit is not changed
// WARN-NOT: {{.}}
// CHECK: published out 3
// JSON-DAG: "comparisons": 0,
// JSON-DAG: "functions": {{[1-9]}}
// JSON-DAG: "failure": "the analysis takes more than 1 s
// JSON-DAG: "status": "failed"
// JSON-DAG: "comparisons": []
