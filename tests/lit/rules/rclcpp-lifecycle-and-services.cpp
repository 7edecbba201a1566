// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-extern-calls>,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The parameters of a lifecycle node, and the exposing statements of ROS 2
// other than a plain publish.
#include <rclcpp_lifecycle/lifecycle_node.hpp>

struct Service {
  struct Request {
    double data;
  };
};

class Node : public rclcpp_lifecycle::LifecycleNode {
public:
  explicit Node(rclcpp::Client<Service> &Caller)
      : rclcpp_lifecycle::LifecycleNode("node"), Caller(Caller) {
    A = declare_parameter("a", rclcpp::ParameterValue(1.5)).get<double>();
    B = get_parameter("b").as_double();
  }
  // CHECK: exposing statements of {{.*}}: 2
  void step(double V,
            rclcpp_lifecycle::LifecyclePublisher<std_msgs::msg::Number> Out) {
    std_msgs::msg::Number M;
    auto Request = std::make_shared<Service::Request>();
    // CHECK-DAG: parameter 'a' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V > A)
      // CHECK-DAG: LifecyclePublisher::publish topic '' in {{.*}} at [[#@LINE+1]]:11
      Out.publish(M);
    // CHECK-DAG: parameter 'b' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V > B)
      // CHECK-DAG: rclcpp::Client::async_send_request topic '' in {{.*}} at [[#@LINE+1]]:14
      Caller.async_send_request(Request);
  }

private:
  rclcpp::Client<Service> &Caller;
  double A, B;
};

void run(double V) {
  rclcpp::Client<Service> Caller;
  Node(Caller).step(V, {});
}
