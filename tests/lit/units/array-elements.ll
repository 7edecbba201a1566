; RUN: %opt -disable-output -passes='print<tpc-class-object-access>' %s | FileCheck %s
;
; ClassObjectAccess: which element of an array a pointer leads to, however it is
; computed.
target datalayout = "e-m:e-i64:64-n32:64-S128"
%class.Pair = type { i32, i32 }
%class.Table = type { double, [3 x %class.Pair], [2 x [3 x i32]] }

@numbers = global [8 x i32] zeroinitializer
@pairs = global [4 x %class.Pair] zeroinitializer

; A path through an array continues into the class of its elements.
; CHECK-LABEL: accesses of
; CHECK-NEXT: load [class.Pair.1] in fieldBehindArray
define i32 @fieldBehindArray(ptr %p) {
  %a = getelementptr [4 x %class.Pair], ptr %p, i64 0, i64 1, i32 1
  %v = load i32, ptr %a
  ret i32 %v
}

; Element 1 of a class's array; in rows of three, the last of the second is number 5.
; CHECK-NEXT: load [class.Table.1][1][class.Pair.0] in fields
; CHECK-NEXT: load [class.Table.2][5] in fields
define i32 @fields(ptr %t) {
  %a = getelementptr %class.Table, ptr %t, i64 0, i32 1, i64 1
  %v = load i32, ptr %a
  %b = getelementptr %class.Table, ptr %t, i64 0, i32 2, i64 1
  %c = getelementptr [3 x i32], ptr %b, i64 0, i64 2
  %w = load i32, ptr %c
  %sum = add i32 %v, %w
  ret i32 %sum
}

; At the beginning, by bytes (12 = 3 * 4), by elements in two steps (1 + 2),
; before the beginning, and at an unknown index.
; CHECK-NEXT: load @numbers[0] in global
; CHECK-NEXT: load @numbers[3] in global
; CHECK-NEXT: load @numbers[3] in global
; CHECK-NEXT: load @numbers[any] in global
; CHECK-NEXT: load @numbers[any] in global
define void @global(i64 %i) {
  %v = load i32, ptr @numbers
  %a = getelementptr i8, ptr @numbers, i64 12
  %w = load i32, ptr %a
  %b = getelementptr i32, ptr @numbers, i64 1
  %c = getelementptr i32, ptr %b, i64 2
  %x = load i32, ptr %c
  %d = getelementptr i32, ptr @numbers, i64 -1
  %y = load i32, ptr %d
  %e = getelementptr [8 x i32], ptr @numbers, i64 0, i64 %i
  %z = load i32, ptr %e
  ret void
}

; 20 bytes are two pairs of eight and the first number of one.
; CHECK-NEXT: load @pairs[0][class.Pair.1] in objects
; CHECK-NEXT: load @pairs[2][class.Pair.1] in objects
; CHECK-NEXT: load @pairs[any][class.Pair.1] in objects
define void @objects(i64 %i) {
  %a = getelementptr %class.Pair, ptr @pairs, i64 0, i32 1
  %v = load i32, ptr %a
  %b = getelementptr i8, ptr @pairs, i64 20
  %w = load i32, ptr %b
  %c = getelementptr %class.Pair, ptr @pairs, i64 %i, i32 1
  %x = load i32, ptr %c
  ret void
}

; What one load reads: the two after the sixth; for pairs, the second half of
; one and the first half of the next.
; CHECK-NEXT: load @numbers[6] in atOnce
; CHECK-NEXT: load @numbers[7] in atOnce
; CHECK-NEXT: load @pairs[1][class.Pair.1] in atOnce
; CHECK-NEXT: load @pairs[2][class.Pair.0] in atOnce
define void @atOnce() {
  %a = getelementptr [8 x i32], ptr @numbers, i64 0, i64 6
  %v = load <2 x i32>, ptr %a
  %b = getelementptr [4 x %class.Pair], ptr @pairs, i64 0, i64 1, i32 1
  %w = load i64, ptr %b
  ret void
}

; A pointer that moves on in a loop: the first element, then any.
; CHECK-NEXT: load @numbers[0] in walk
; CHECK-NEXT: load @numbers[any] in walk
define void @walk(ptr %end) {
entry:
  br label %loop
loop:
  %p = phi ptr [ @numbers, %entry ], [ %next, %loop ]
  %v = load i32, ptr %p
  %next = getelementptr i32, ptr %p, i64 1
  %done = icmp eq ptr %next, %end
  br i1 %done, label %out, label %loop
out:
  ret void
}
