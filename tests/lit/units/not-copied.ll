; RUN: %opt -passes=tpc -S %s | FileCheck %s
;
; A function that another link unit may replace is not copied for its calls, and
; an alias is not resolved to the definition in this file.
; CHECK: define weak i32 @replaceable
; CHECK-NOT: @replaceable.tpc
; CHECK: call i32 @replaceable(
; CHECK: call i32 @alias(
@alias = alias i32 (i32), ptr @replaceable

define weak i32 @replaceable(i32 %x) {
  ret i32 %x
}

define i32 @main() {
  %1 = call i32 @replaceable(i32 1)
  %2 = call i32 @alias(i32 2)
  %3 = add i32 %1, %2
  ret i32 %3
}
