// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %native -DLIBRARY -c %s -o %t.library.o
// RUN: %link -O0 %t.0.o %t.ros.o %t.library.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %link -O2 %t.2.o %t.ros.o %t.library.o -o %t.2
// RUN: %t.2 | FileCheck %s
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.alone
// RUN: %t.alone | FileCheck %s --check-prefix=ALONE
//
// A report gets the object whose class reads parameters: in its methods, in
// those of its base class and members, and in a lambda of a method. Objects of
// other classes, and functions, have one report for all.
// ALONE-NOT: object
// ALONE: report 1 cmp 1 thresh 2
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

void log_read_of(char *, const void *, const void *Name, bool IsText,
                 const void *Object, unsigned long Size) {
  std::printf("object %u of %lu bytes reads %s\n", numberOf(Object), Size,
              IsText ? "" : *static_cast<const char *const *>(Name));
}
#else
#include <ros/ros.h>

static ros::NodeHandle Handle;
static ros::Publisher Out;

static void publishIf(bool Is) {
  if (Is)
    Out.publish(std_msgs::Number());
}

struct Band {
  double Width = 0;
  __attribute__((noinline)) bool has(double V) const { return V < Width; }
};

class Check {
public:
  __attribute__((noinline)) bool isHigh(double V) const { return V > High; }

protected:
  double High = 0;
};

class Limiter : public Check {
public:
  explicit Limiter(const std::string &Name) {
    Handle.param(Name + "/low", Low, 2.0);
    Handle.param(Name + "/high", High, 4.0);
    Handle.param(Name + "/width", Own.Width, 5.0);
  }
  __attribute__((noinline)) bool isLow(double V) const { return V < Low; }
  __attribute__((noinline)) bool isLowInLambda(double V) const {
    auto Is = [this](double X) __attribute__((noinline)) { return X < Low; };
    return Is(V);
  }

  Band Own;

private:
  double Low;
};

/// Many of these exist, and none of them reads a parameter.
struct Obstacle {
  double Size;
  __attribute__((noinline)) bool isLarge(double Than) const {
    return Size > Than;
  }
};

static __attribute__((noinline)) bool isFar(double V, double Limit) {
  return V > Limit;
}

int main() {
  Out = Handle.advertise<std_msgs::Number>("out", 1);
  // CHECK: object 1 of [[SIZE:[0-9]+]] bytes reads a/low
  // CHECK: object 1 of [[SIZE]] bytes reads a/high
  // CHECK: object 2 of [[SIZE]] bytes reads b/low
  Limiter A("a"), B("b");
  // CHECK: object 1: 1 cmp 1 thresh 2
  publishIf(A.isLow(1));
  // CHECK: object 2: 0 cmp 3 thresh 2
  publishIf(B.isLow(3));
  // CHECK: object 1: 0 cmp 3 thresh 4
  publishIf(A.isHigh(3));
  // CHECK: object 2: 1 cmp 5 thresh 4
  publishIf(B.isHigh(5));
  // CHECK: object 1: 0 cmp 6 thresh 2
  publishIf(A.isLowInLambda(6));
  // CHECK: object 2: 1 cmp 0 thresh 2
  publishIf(B.isLowInLambda(0));
  // CHECK: object {{[34]}}: 1 cmp 0 thresh 5
  publishIf(A.Own.has(0));
  // CHECK: object {{[34]}}: 0 cmp 7 thresh 5
  publishIf(B.Own.has(7));
  double Least;
  Handle.param("least", Least, 8.0);
  // CHECK: report 1 cmp 9 thresh 8
  publishIf(isFar(9, Least));
  Obstacle Some[] = {{7}, {9}};
  // CHECK: report 0 cmp 7 thresh 8
  // CHECK: report 1 cmp 9 thresh 8
  for (const Obstacle &Each : Some)
    publishIf(Each.isLarge(Least));
}
#endif
