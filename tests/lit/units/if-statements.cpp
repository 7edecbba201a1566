// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-if-statements>' %t.o | FileCheck %s
//
// IfStatements: a block and the branches that control it, with a loop that is
// entered by the function and by itself. An if's branch stands where the if
// stands, or (later than clang 19) where its condition does.
int f(int A, int B) {
  // CHECK: predicates of {{.*}}: 3
  // CHECK: _Z1fii %[[#]] controlled by entry
  // CHECK: _Z1fii %[[#]] controlled by %[[#]] at [[#@LINE+1]]:{{7|9}}
  if (A > 1)
    return 7;
  // CHECK: _Z1fii %[[#]] controlled by %[[#]] at [[#@LINE-2]]:{{7|9}} %[[#]] at [[#@LINE+1]]:3
  while (B > 3) {
    // CHECK: _Z1fii %[[#]] controlled by %[[#]] at [[#@LINE-1]]:3
    // CHECK: _Z1fii %[[#]] controlled by %[[#]] at [[#@LINE+1]]:{{9|11}}
    if (B == 5)
      --B;
    --B;
  }
  return B;
}
