// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-extern-calls>,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-extern-calls>,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// What the callback of a service writes into its response is what it answers;
// what it counts is not.
#include <rclcpp/rclcpp.hpp>

struct Judge_Request_ {
  double value = 0;
};
struct Judge_Response_ {
  bool success = false;
  std::string message;
};
struct Judge {
  using Request = Judge_Request_;
  using Response = Judge_Response_;
};

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    A = declare_parameter<double>("a", 1.5);
    B = declare_parameter<double>("b", 1.5);
    C = declare_parameter<double>("c", 1.5);
    D = declare_parameter<double>("d", 1.5);
    Bound = create_service<Judge>("bound", std::bind(&Node::judge, this,
                                                     std::placeholders::_1,
                                                     std::placeholders::_2));
    Lambda = create_service<Judge>(
        "lambda", [this](std::shared_ptr<Judge::Request> Request,
                         std::shared_ptr<Judge::Response> Response) {
          // CHECK-DAG: parameter 'd' relation > {{.*}} at [[#@LINE+1]]:30
          if (Request->value > D)
            Response->success = true;
        });
  }
  // CHECK-DAG: create_service topic 'create_service -> Response' in
  // CHECK-DAG: threshold predicate comparisons of {{.*}}: 3
  void judge(const std::shared_ptr<Judge::Request> Request,
             std::shared_ptr<Judge::Response> Response) {
    // CHECK-DAG: parameter 'a' relation > {{.*}} at [[#@LINE+1]]:40
    Response->message = Request->value > A ? "high" : "low";
    // CHECK-DAG: parameter 'b' relation > as x distance 2 {{.*}} at [[#@LINE+1]]:24
    if (Request->value > B)
      Response->success = true;
    if (Request->value > C)
      ++Noted;
  }

private:
  std::shared_ptr<rclcpp::Service<Judge>> Bound, Lambda;
  double A, B, C, D;
  int Noted = 0;
};

void run() { Node(); }
