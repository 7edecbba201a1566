// RUN: %compile -std=c++20 -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -std=c++20 -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// Some passes that split a coroutine must run in the compiler and others need
// not; here both run, at every level.
// CHECK: 0 1 4 9 end 14
#include <coroutine>
#include <cstdio>
#include <utility>

struct Squares {
  struct promise_type {
    int Value = 0;
    Squares get_return_object() {
      return Squares{std::coroutine_handle<promise_type>::from_promise(*this)};
    }
    std::suspend_always initial_suspend() { return {}; }
    std::suspend_always final_suspend() noexcept { return {}; }
    std::suspend_always yield_value(int V) {
      Value = V;
      return {};
    }
    void return_void() {}
    void unhandled_exception() {}
  };
  explicit Squares(std::coroutine_handle<promise_type> H) : Handle(H) {}
  Squares(Squares &&Other) : Handle(std::exchange(Other.Handle, {})) {}
  ~Squares() {
    if (Handle)
      Handle.destroy();
  }
  std::coroutine_handle<promise_type> Handle;
};

static Squares squares(int Limit) {
  for (int I = 0; I < Limit; ++I)
    co_yield I *I;
}

int main() {
  Squares Made = squares(4);
  int Sum = 0;
  for (Made.Handle.resume(); !Made.Handle.done(); Made.Handle.resume()) {
    std::printf("%d ", Made.Handle.promise().Value);
    Sum += Made.Handle.promise().Value;
  }
  std::printf("end %d\n", Sum);
}
