// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %inputs/node.cpp -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-inject-failure=crash -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t.crash 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t.crash | FileCheck %s --implicit-check-not=report
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
// RUN: %link -O2 -Wl,-mllvm,-tpc-inject-failure=overflow -Wl,-mllvm,-tpc-link-unit=node %t.o %t.ros.o -o %t.overflow 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t.overflow | FileCheck %s --implicit-check-not=report
// RUN: %link -O2 -Wl,-mllvm,-tpc-inject-failure=fatal -Wl,-mllvm,-tpc-link-unit=node %t.o %t.ros.o -o %t.fatal 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t.fatal | FileCheck %s --implicit-check-not=report
// RUN: %link -O2 -Wl,-mllvm,-tpc-inject-failure=allocation -Wl,-mllvm,-tpc-link-unit=node %t.o %t.ros.o -o %t.allocation 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t.allocation | FileCheck %s --implicit-check-not=report
//
// A crash inside the analysis costs one warning and an entry in the file, not
// the build: the program is linked without reports. The same holds for a stack
// overflow, a fatal error of LLVM, and memory that runs out.
// WARN: warning: node: the analysis crashed; this link unit is not changed
// WARN-NOT: {{.}}
// CHECK: published out 3
// JSON-DAG: "status": "failed"
// JSON-DAG: "failure": "the analysis crashed"
// JSON-DAG: "comparisons": []
