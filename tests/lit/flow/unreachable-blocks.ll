; RUN: %opt -disable-output -passes=tpc -tpc-max-memory=256 -tpc-link-unit=unit -tpc-static-info=%t.json %s
; RUN: FileCheck %s --input-file=%t.json
;
; In unreachable blocks, IR allows a value that is computed from itself. Such
; blocks are ignored, and the analysis ends.
; CHECK: "functions": 1
; CHECK: "status": "ok"
define i32 @f(ptr %p, i1 %c) {
  ret i32 0
dead:
  %q = getelementptr i32, ptr %q, i64 1
  %r = freeze ptr %r
  %a = load i32, ptr %q
  %b = load i32, ptr %r
  store ptr %q, ptr %r
  %s = add i32 %a, %b
  br label %dead
}
