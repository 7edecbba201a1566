// RUN: rm -rf %t && mkdir -p %t/plans
// RUN: %compile -O2 %s -o %t/main.o
//
// A link that fails leaves no state, and its exit status is passed on.
// RUN: not %again %t/main.o %t/missing.o -o %t/main 2>&1 | FileCheck %s --check-prefixes=CHECK,MISSING
// RUN: not ls %t/unit.link.json.state
// RUN: sh -c '%relink sh -c "exit 3" -tpc-manifest=%t/a -tpc-static-info=%t/b -tpc-plans=%t/c -o %t/d; echo status $?' | FileCheck %s --check-prefix=STATUS
//
// A broken state or list of files is no state.
// RUN: %again %t/main.o -o %t/main | FileCheck %s
// RUN: echo "{" > %t/unit.link.json.state
// RUN: %again %t/main.o -o %t/main | FileCheck %s
// RUN: echo '{"schema": 1}' > %t/unit.link.json.state
// RUN: %again %t/main.o -o %t/main | FileCheck %s
// RUN: %again %t/main.o -Wl,--dependency-file=/dev/null -o %t/main | FileCheck %s
// RUN: %again %t/main.o -Wl,--dependency-file=/dev/null -o %t/main | FileCheck %s
//
// The linker does not list the members of a thin archive.
// RUN: %tpc-ar rcT %t/libmain.a %t/main.o
// RUN: %again %t/libmain.a -o %t/main | FileCheck %s
// RUN: %again %t/libmain.a -o %t/main | FileCheck %s
//
// Other commands are run as they are.
// RUN: %relink echo Linked 2>&1 | FileCheck %s
// RUN: not %relink %t/no-such-command 2>&1 | FileCheck %s --check-prefix=NONE
// RUN: not %relink 2>&1 | FileCheck %s --check-prefix=USAGE

// CHECK: Linked
// MISSING: missing.o
// STATUS: status 3
// NONE: tpc-relink: {{.*}}no-such-command: No such file or directory
// USAGE: usage: tpc-relink COMMAND...

int main() { return 0; }
