// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-if-statements>' %t.o | FileCheck %s
//
// IfStatements: a block and the branches that control it, with a loop that is
// controlled by the entry and by itself. The branch of an if has the place of
// the if or (after clang 19) that of its condition.
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
