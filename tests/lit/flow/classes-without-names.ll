; RUN: %opt -disable-output -passes='print<tpc-class-object-access>' %s | FileCheck %s
;
; Classes that have lost their names and look alike, one inside the other, are
; not taken for one; and a class that contains another one with its name is not
; followed without end.
%0 = type { %1 }
%1 = type { %2 }
%2 = type { i32 }
%class.A = type { %class.A.1 }
%class.A.1 = type { %class.A.2 }
%class.A.2 = type { i32 }

; CHECK: load @unnamed[literal.0][literal.0][literal.0] in f
; CHECK: load @named[class.A.0]
@unnamed = global %0 zeroinitializer
@named = global %class.A zeroinitializer

define i32 @f() {
  %a = load i32, ptr @unnamed
  %b = load i32, ptr @named
  %c = add i32 %a, %b
  ret i32 %c
}
