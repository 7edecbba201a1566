// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// The lambda of copied-closure.cpp is made by a function that returns it
// through a hidden argument: what the argument holds, the local holds.
#include <new>
#include <ros/ros.h>

struct Function {
  void *Held;
  void (*Invoke)(void *, double);
  template <typename F> static Function of(const F &Callable) {
    return {new F(Callable),
            [](void *Kept, double Here) { (*static_cast<F *>(Kept))(Here); }};
  }
};

Function Registered;

auto receiver(double &Lower, ros::Publisher &Out, int &Count) {
  return [&](double Here) {
    // CHECK: comparisons of {{.*}}: 1
    // CHECK-NEXT: parameter 'lower' relation < {{.*}} at [[#@LINE+1]]:14
    if (Here < Lower)
      Out.publish(std_msgs::Number());
    ++Count;
  };
}

int main() {
  ros::NodeHandle Handle;
  double Lower = 0;
  Handle.param("lower", Lower, -4.0);
  ros::Publisher Out;
  int Count = 0;
  auto Receive = receiver(Lower, Out, Count);
  Registered = Function::of(Receive);
  Registered.Invoke(Registered.Held, 1);
}
