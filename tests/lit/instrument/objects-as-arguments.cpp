// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %native -DLIBRARY -c %s -o %t.library.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o %t.library.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o %t.library.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// The argument of a function is no object with reports of its own if only the
// class that has such a field reads parameters: it may be a copy. The method's
// object is taken then. If the threshold is that of another object, and which
// one is chosen at run time, there is none.
#ifdef LIBRARY
#include <cstdio>
#include <map>

static unsigned numberOf(const void *Object) {
  static std::map<const void *, unsigned> Known;
  return Known.try_emplace(Object, Known.size() + 1).first->second;
}

void log_one_of(char *, bool Result, double Cmp, double Thresh, bool,
                const void *Object) {
  std::printf("object %u: %d cmp %g thresh %g\n", numberOf(Object), Result, Cmp,
              Thresh);
}
#else
#include <ros/ros.h>

static ros::NodeHandle Handle;
static ros::Publisher Out;

struct Settings {
  double High = 0;
  double More[8] = {};
};

struct Limiter {
  explicit Limiter(const std::string &Name) {
    Handle.param(Name + "/low", Low, 2.0);
  }
  double Low;
};

class Node {
public:
  Node(const std::string &Name, Limiter &A, Limiter &B) : A(&A), B(&B) {
    Handle.param(Name + "/high", Own.High, 4.0);
  }
  __attribute__((noinline)) void take(double V, Settings &Now) {
    if (V > Now.High)
      Out.publish(std_msgs::Number());
  }
  __attribute__((noinline)) void takeCopy(double V) {
    Settings Copy = Own;
    take(V, Copy);
  }
  __attribute__((noinline)) void choose(double V, bool First) {
    Limiter *L = First ? A : B;
    if (V < L->Low)
      Out.publish(std_msgs::Number());
  }
  Settings Own;

private:
  Limiter *A, *B;
};

static __attribute__((noinline)) void takeIn(double V, const Limiter &L) {
  if (V < L.Low)
    Out.publish(std_msgs::Number());
}

int main() {
  Out = Handle.advertise<std_msgs::Number>("out", 1);
  Limiter A("a"), B("b");
  Node One("one", A, B), Two("two", A, B);
  // CHECK: object 1: 1 cmp 5 thresh 4
  One.take(5, One.Own);
  // CHECK: object 2: 0 cmp 3 thresh 4
  Two.take(3, Two.Own);
  // CHECK: object 1: 1 cmp 6 thresh 4
  One.takeCopy(6);
  // CHECK: object 2: 0 cmp 2 thresh 4
  Two.takeCopy(2);
  // CHECK: report 1 cmp 1 thresh 2
  One.choose(1, true);
  // CHECK: report 0 cmp 3 thresh 2
  Two.choose(3, false);
  // Its own methods read: as if it were its method.
  // CHECK: object 3: 1 cmp 0 thresh 2
  takeIn(0, A);
  // CHECK: object 4: 0 cmp 9 thresh 2
  takeIn(9, B);
}
#endif
