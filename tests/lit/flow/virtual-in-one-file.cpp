// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-callgraph>,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Virtual calls of classes whose debug information has no name across
// files: classes whose vtable is in this file, because their first
// virtual function that is not inline is, and classes that no other file
// can name.
#include <ros/ros.h>

#include <cmath>

double sensed();

// CHECK: indirect calls: 0
// CHECK: comparisons of {{.*}}: 9
namespace drive {

struct Controller {
  virtual ~Controller() = default;
  virtual bool compute(double Heading) = 0;
};

// Called on `this`, and by a pointer to the pure base class.
class Pursuit : public Controller {
public:
  bool compute(double Heading) override;
  double Tolerance;

protected:
  virtual bool aligned(double Error) const;
};

bool Pursuit::compute(double Heading) { return aligned(Heading); }

bool Pursuit::aligned(double Error) const {
  // CHECK-DAG: derived 'tolerance' relation < as 0.5 * x {{.*}} at [[#@LINE+1]]:27
  return std::fabs(Error) < Tolerance;
}

class Faulty : public Pursuit {
  bool aligned(double Error) const override {
    // CHECK-DAG: derived 'tolerance' relation > as 0.5 * x {{.*}} at [[#@LINE+1]]:29
    return std::fabs(Error) > Tolerance;
  }
};

// For a template, the name alone does not say how it is mangled.
template <typename T> struct Band {
  virtual bool holds(T) const { return true; }
  T Width;
};
template <> struct Band<int> {
  virtual bool holds(int) const;
  int Width;
};
bool Band<int>::holds(int Value) const {
  // CHECK-DAG: 'width' relation < as x {{.*}} at [[#@LINE+1]]:16
  return Value < Width;
}

} // namespace drive

// At file scope, nested.
struct Outer {
  struct Inner {
    virtual bool over(double) const;
    bool asked() const { return over(sensed()); }
    double Most;
  };
};
bool Outer::Inner::over(double Value) const {
  // CHECK-DAG: 'most' relation > as x {{.*}} at [[#@LINE+1]]:16
  return Value > Most;
}

namespace {

struct Shape {
  virtual bool far(double) const = 0;
};
struct Round : Shape {
  double Radius;
  bool far(double Value) const override {
    // CHECK-DAG: 'radius' relation > as x {{.*}} at [[#@LINE+1]]:18
    return Value > Radius;
  }
};

struct Near {
  virtual ~Near() = default;
  virtual bool near(double Value) const {
    // CHECK-DAG: 'reach' relation < as x {{.*}} at [[#@LINE+1]]:18
    return Value < Reach;
  }
  bool asked() const { return near(sensed()); }
  double Reach;
};
struct Nearer : Near {
  bool near(double Value) const override {
    // CHECK-DAG: 'reach' relation <= as x {{.*}} at [[#@LINE+1]]:18
    return Value <= Reach;
  }
};

// An object that needs no constructor.
struct Gate {
  virtual bool open(double Value) const {
    // CHECK-DAG: 'level' relation >= as x {{.*}} at [[#@LINE+1]]:18
    return Value >= Level;
  }
  bool asked() const { return open(sensed()); }
  double Level = 0;
};
struct Gates {
  int Count = 1;
  Gate Only;
} AllGates;
Gate OneGate;

} // namespace

bool drives(drive::Controller &C, Shape &S) {
  return C.compute(sensed()) && S.far(sensed());
}

int main(int Count, char **) {
  struct Local {
    virtual bool full(double Value) const {
      // CHECK-DAG: 'volume' relation >= as x {{.*}} at [[#@LINE+1]]:20
      return Value >= Volume;
    }
    bool asked() const { return full(sensed()); }
    double Volume;
  };
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  drive::Pursuit Right;
  drive::Faulty Wrong;
  drive::Band<int> Band, *Bands = &Band;
  Outer::Inner Inner;
  Round Circle;
  Nearer Nearest;
  Local Tank;
  double Twice;
  Handle.param("tolerance", Twice, 1.0);
  Wrong.Tolerance = Right.Tolerance = Twice / 2;
  Handle.param("width", Band.Width, 1);
  Handle.param("most", Inner.Most, 1.0);
  Handle.param("radius", Circle.Radius, 1.0);
  Handle.param("reach", Nearest.Reach, 1.0);
  Handle.param("level", OneGate.Level, 1.0);
  Handle.param("volume", Tank.Volume, 1.0);
  if (drives(Count > 1 ? Right : Wrong, Circle) && Bands->holds(Count) &&
      Inner.asked() && Nearest.asked() && OneGate.asked() &&
      AllGates.Only.asked() && Tank.asked())
    Out.publish(std_msgs::Number());
}
