// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %inputs/node.cpp -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-inject-failure=memory -Wl,-mllvm,-tpc-max-memory=64 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t | FileCheck %s
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
//
// As for time, so for memory: one warning, an entry in the file, and reports of
// what was found.
// WARN: warning: node: the analysis does not fit into 64 MiB (-tpc-max-memory raises the limit, TPC_MAX_MEMORY in CMake); the comparisons found so far will report, others may be missing
// WARN-NOT: {{.}}
// CHECK: report
// CHECK: published out 3
// JSON-DAG: "incomplete": "the analysis does not fit into 64 MiB
// JSON-DAG: "status": "ok"
