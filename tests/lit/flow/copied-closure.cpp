// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A lambda holds the addresses of what it captures. It is copied bytewise into
// a function object, which calls the copy through a pointer without a class.
// Nothing keeps the address of the lambda itself.
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

int main() {
  ros::NodeHandle Handle;
  double Lower = 0;
  Handle.param("lower", Lower, -4.0);
  ros::Publisher Out;
  auto Receive = [&](double Here) {
    // CHECK: comparisons of {{.*}}: 1
    // CHECK-NEXT: parameter 'lower' relation < {{.*}} at [[#@LINE+1]]:14
    if (Here < Lower)
      Out.publish(std_msgs::Number());
  };
  Registered = Function::of(Receive);
  Registered.Invoke(Registered.Held, 1);
}
