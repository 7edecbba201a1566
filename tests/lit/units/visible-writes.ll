; RUN: %opt -disable-output -passes='print<tpc-visible-writes>' %s | FileCheck %s
;
; VisibleWrites: the writes of a variable that a read can see.
target datalayout = "e-m:e-i64:64-n32:64-S128"

@shared = global i32 0
declare void @fill(ptr)

; The last of two, here and in other functions.
; CHECK-LABEL: visible writes of
; CHECK-NEXT: %v in last
; CHECK-NEXT: store i32 2, ptr @shared, align 4 in last
define i32 @last() {
  store i32 1, ptr @shared
  store i32 2, ptr @shared
  %v = load i32, ptr @shared
  ret i32 %v
}
; CHECK-NEXT: %w in other
; CHECK-NEXT: store i32 2, ptr @shared, align 4 in last
define i32 @other() {
  %w = load i32, ptr @shared
  ret i32 %w
}

; Both of two paths to the read of a local variable; a call that gets a pointer
; to the variable writes it, and replaces nothing.
; CHECK-NEXT: %x in local
; CHECK-NEXT: store i32 3, ptr %variable, align 4 in local
; CHECK-NEXT: store i32 4, ptr %variable, align 4 in local
; CHECK-NEXT: %y in local
; CHECK-NEXT: store i32 5, ptr %variable, align 4 in local
; CHECK-NEXT: call void @fill(ptr %variable) in local
; CHECK-NOT: {{.}}
define i32 @local(i1 %c) {
  %variable = alloca i32
  store i32 3, ptr %variable
  br i1 %c, label %then, label %end
then:
  store i32 4, ptr %variable
  br label %end
end:
  %x = load i32, ptr %variable
  store i32 5, ptr %variable
  call void @fill(ptr %variable)
  %y = load i32, ptr %variable
  %sum = add i32 %x, %y
  ret i32 %sum
}
