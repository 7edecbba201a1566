// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A throw decides nothing about what is exposed before the call, or after a
// handler caught it (its own type, a base, any), or where it ends the program.
// Neither does a throw in a library, or behind a call whose function has no body.
#include <ros/ros.h>

#include <stdexcept>
#include <vector>

struct Fault {};
struct Special : Fault {};

double Before, Same, Base, Standard, Any, Here, Ending, Passed, Library;

// CHECK: comparisons of {{.*}}: 0
void checkBefore(double V) {
  if (V > Before)
    throw Fault();
}
void before(ros::Publisher &Out, double V) {
  Out.publish(std_msgs::Number());
  checkBefore(V);
}

void checkSame(double V) {
  if (V > Same)
    throw Fault();
}
void checkBase(double V) {
  if (V > Base)
    throw Special();
}
void checkStandard(double V) {
  if (V > Standard)
    throw std::out_of_range("over");
}
void checkAny(double V) {
  if (V > Any)
    throw 1;
}
void checkPassed(double V) {
  if (V > Passed)
    throw Special();
}
void letThrough(double V) { checkPassed(V); }
void swallowed(ros::Publisher &Out, double V) {
  int Bad = 0;
  try {
    checkSame(V);
    checkBase(V);
    letThrough(V);
  } catch (const Fault &) {
    ++Bad;
  }
  try {
    checkStandard(V);
  } catch (const std::exception &) {
    ++Bad;
  }
  try {
    checkAny(V);
  } catch (...) {
    ++Bad;
  }
  try {
    // That the constructor may throw too does not matter.
    if (V > Here)
      throw std::out_of_range("over");
    ++Bad;
  } catch (const std::out_of_range &) {
    --Bad;
  }
  Out.publish(std_msgs::Number());
}

void checkEnding(double V) noexcept {
  if (V > Ending)
    throw Fault();
}
void ending(ros::Publisher &Out, double V) {
  checkEnding(V);
  Out.publish(std_msgs::Number());
}

void elsewhere();
double element(const std::vector<double> &Values, double V) {
  if (V > Library)
    elsewhere();
  return Values.at(0);
}
void library(ros::Publisher &Out, const std::vector<double> &Values, double V) {
  element(Values, V);
  Out.publish(std_msgs::Number());
}

void read(ros::NodeHandle &Handle) {
  Handle.param("before", Before, 1.0);
  Handle.param("same", Same, 1.0);
  Handle.param("base", Base, 1.0);
  Handle.param("standard", Standard, 1.0);
  Handle.param("any", Any, 1.0);
  Handle.param("here", Here, 1.0);
  Handle.param("ending", Ending, 1.0);
  Handle.param("passed", Passed, 1.0);
  Handle.param("library", Library, 1.0);
}
