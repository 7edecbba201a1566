// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %inputs/node.cpp -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-inject-failure=memory -Wl,-mllvm,-tpc-max-memory=64 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t | FileCheck %s --implicit-check-not=report
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
//
// As for time, so for memory: one warning, an entry in the file, no reports.
// WARN: warning: node: the analysis takes more than 64 MiB (-tpc-max-memory raises the limit, TPC_MAX_MEMORY in CMake); this link unit is not changed
// WARN-NOT: {{.}}
// CHECK: published out 3
// JSON-DAG: "failure": "the analysis takes more than 64 MiB
// JSON-DAG: "status": "failed"
