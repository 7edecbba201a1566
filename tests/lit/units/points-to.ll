; RUN: %opt -disable-output -passes='print<tpc-points-to>' %s | FileCheck %s
;
; PointsTo: pointers are followed through phis, arguments, results and memory.
target datalayout = "e-m:e-i64:64-n32:64-S128"
%class.Node = type { ptr, i32 }

@one = global i32 0
@two = global i32 0
@kept = global ptr null

; Any operand of a phi.
; CHECK-LABEL: pointers of
; CHECK-NEXT: %either in choose leads to @one @two
define void @choose(i1 %c) {
  %either = select i1 %c, ptr @one, ptr @two
  store i32 1, ptr %either
  ret void
}

; What the calls pass; a field is that of any object of its class.
; CHECK-NEXT: %p in set leads to @one @two
; CHECK-NEXT: %n in set leads nowhere that is known
; CHECK-NEXT: %field in set leads to [class.Node.1]
define void @set(ptr %p, ptr %n) {
  store i32 1, ptr %p
  %field = getelementptr %class.Node, ptr %n, i64 0, i32 1
  store i32 2, ptr %field
  ret void
}

; A result that is an argument is the argument of this very call.
; CHECK-NEXT: %a in same leads to @one @two
; CHECK-NEXT: %first in calls leads to @one
; CHECK-NEXT: %second in calls leads to @two
define internal ptr @same(ptr %a) {
  ret ptr %a
}
define void @calls(i1 %c) {
  call void @set(ptr @one, ptr null)
  call void @set(ptr @two, ptr null)
  %first = call ptr @same(ptr @one)
  store i32 1, ptr %first
  %second = call ptr @same(ptr @two)
  store i32 1, ptr %second
  ret void
}

; Loads of a variable find what is stored to it.
; CHECK-NEXT: %found in load leads to @two
define void @keep() {
  store ptr @two, ptr @kept
  ret void
}
define i32 @load() {
  %found = load ptr, ptr @kept
  %v = load i32, ptr %found
  ret i32 %v
}
