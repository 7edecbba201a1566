// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// All of an object that is put into a list is published with the list's
// elements, not only its first field, also where the list is made in braces.
#include <ros/ros.h>

#include <string>
#include <vector>

struct Inner {
  double X, Y;
};
struct Plain {
  double data;
  Inner In;
};
struct Named {
  double data;
  std::string Name;
  Inner In;
};

template <typename M> void send(ros::Publisher &Out, const std::vector<M> &All) {
  for (const M &Each : All)
    Out.publish(Each);
}

// CHECK: comparisons of {{.*}}: 4
void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double Pushed, Braced, Kept, Called;
  Handle.param("pushed", Pushed, 1.0);
  Handle.param("braced", Braced, 2.0);
  Handle.param("kept", Kept, 3.0);
  Handle.param("called", Called, 4.0);
  Plain First{}, Second{}, Third{};
  Named Fourth{}, Fifth{};
  // CHECK-DAG: parameter 'pushed' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Pushed)
    First.In.Y = 1;
  // CHECK-DAG: parameter 'braced' relation < {{.*}} at [[#@LINE+1]]:9
  if (V < Braced)
    Second.In.Y = 1;
  if (V > Kept)
    Third.In.Y = 1;
  std::vector<Plain> List, Other;
  List.push_back(First);
  Other.push_back(Third);
  send(Out, List);
  send(Out, std::vector<Plain>{Second});
  // The program's own code copies these.
  // CHECK-DAG: parameter 'called' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Called)
    Fourth.In.Y = 1;
  // CHECK-DAG: parameter 'called' relation < {{.*}} at [[#@LINE+1]]:9
  if (V < Called)
    Fifth.In.Y = 1;
  std::vector<Named> Names;
  Names.push_back(Fourth);
  send(Out, Names);
  send(Out, std::vector<Named>{Fifth});
}
