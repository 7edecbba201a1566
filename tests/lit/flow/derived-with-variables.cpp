// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A threshold that is computed from a parameter and other values is reported
// with the expression. No threshold is left where the parameter only scales
// what is compared with a constant, moves a sum on, or is on both sides.
#include <ros/ros.h>

double Speed, Factor, Sum;
struct Timer {
  double Last = 0, Deadline = 0;
} Patient;

void publish() { ros::Publisher().publish(std_msgs::Number()); }

void step(ros::NodeHandle &Handle, double Value, int Count) {
  // CHECK: comparisons of {{.*}}: 9
  double Scaled, Patience, Margin, Gain, Rate, Both, Least, Base, Extra;
  int Every;
  Handle.param("scaled", Scaled, 0.5);
  Handle.param("patience", Patience, 5.0);
  Handle.param("margin", Margin, 0.1);
  Handle.param("every", Every, 10);
  Handle.param("gain", Gain, 2.0);
  Handle.param("rate", Rate, 2.0);
  Handle.param("both", Both, 2.0);
  Handle.param("least", Least, 2.0);
  Handle.param("base", Base, 2.0);
  Handle.param("extra", Extra, 2.0);
  // CHECK-DAG: derived 'scaled' relation > as x * Speed {{.*}} at [[#@LINE+1]]:
  if (Value > Scaled * Speed)
    publish();
  // CHECK-DAG: derived 'patience' relation > as x + Last {{.*}} at [[#@LINE+1]]:
  if (Value > Patient.Last + Patience)
    publish();
  // CHECK-DAG: derived 'margin' relation > as (x + 1) * Speed + Factor {{.*}} at [[#@LINE+1]]:
  if (Value > (1 + Margin) * Speed + Factor)
    publish();
  // CHECK-DAG: derived 'every' relation == as Count rem x {{.*}} at [[#@LINE+1]]:
  if (Count % Every == Count / 7)
    publish();
  // A difference to a value is compared with zero: the value is compared.
  // CHECK-DAG: derived 'least' relation < as x - Value {{.*}} at [[#@LINE+1]]:
  if (Least - Value > 0)
    publish();
  // Two parameters: each with the other as operand.
  // CHECK-DAG: derived 'base' relation > as x + {{.*}} at [[#@LINE+2]]:
  // CHECK-DAG: derived 'extra' relation > as x + {{.*}} at [[#@LINE+1]]:
  if (Value > Base + Extra)
    publish();
  // Through a variable.
  Patient.Deadline = Value + Patience;
  // CHECK-DAG: derived 'patience' relation < as x + Value {{.*}} at [[#@LINE+1]]:
  if (Factor < Patient.Deadline)
    publish();
  // The gain is a part of what is measured.
  // CHECK-DAG: parameter 'scaled' relation > as x {{.*}} at [[#@LINE+1]]:
  if (Gain * Value > Scaled)
    publish();
  // None of these has a threshold that was set.
  // CHECK-NOT: {{'gain'|'rate'|'both'}}
  if (Gain * Value > 10)
    publish();
  Sum += Rate * Value;
  if (Sum < Factor)
    publish();
  double Local = 0;
  for (int N = 0; N < Count; ++N)
    Local += Rate * Factor;
  if (Local > Value)
    publish();
  if (Value > 0.5 * Both + 0.5 * Value)
    publish();
  if (Value + Both > Factor + Both * Speed)
    publish();
}
