// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.o | FileCheck %s
//
// The result of searchParam is a complete name: the namespace of the handle is
// not put before it again, also if the name is stored in a member, or extended.
// It is put before a name that was not searched.
#include <ros/ros.h>

class Node {
public:
  Node() : Private("~") {
    Private.searchParam("kept", Key);
    // CHECK-DAG: 'kept' double default {{.*}} at [[#@LINE+1]]:
    Private.param(Key, A, 1.0);
    std::string Found("sought");
    Private.searchParam("sought", Found);
    // CHECK-DAG: 'sought' double default {{.*}} at [[#@LINE+1]]:
    Private.param(Found, A, 1.0);
    // CHECK-DAG: 'sought/more' double default {{.*}} at [[#@LINE+1]]:
    Private.param(Found + "/more", A, 1.0);
    std::string Plain("plain");
    // CHECK-DAG: '~plain' double default {{.*}} at [[#@LINE+1]]:
    Private.param(Plain, A, 1.0);
  }
  ros::NodeHandle Private;
  std::string Key;
  double A;
};

int main() { Node N; }
