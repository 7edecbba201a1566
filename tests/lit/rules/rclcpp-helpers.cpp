// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.0.o | FileCheck %s
//
// Helpers that declare and read a parameter by a name that they are handed, one
// inside the other: each call has its own name, as has each copy of a helper.
#include <rclcpp/rclcpp.hpp>

// CHECK-NOT: <dynamic>
// CHECK-DAG: declare_parameter 'low' {{.*}}
// CHECK-DAG: get_parameter 'low' double {{.*}}
// CHECK-DAG: declare_parameter 'high' {{.*}}
// CHECK-DAG: get_parameter 'high' double {{.*}}
// CHECK-DAG: declare_parameter 'most' {{.*}}
// CHECK-DAG: get_parameter 'most' long {{.*}}
template <typename N>
void declareOnce(N Of, const std::string &Name,
                 const rclcpp::ParameterValue &Default) {
  if (!Of->has_parameter(Name))
    Of->declare_parameter(Name, Default);
}

template <typename T, typename N>
T valueOf(N Of, const std::string &Name, const T &Default) {
  declareOnce(Of, Name, rclcpp::ParameterValue(Default));
  return Of->get_parameter(Name).template get_value<T>();
}

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    Low = valueOf(this, "low", 1.5);
    High = valueOf(this, "high", 2.5);
    Most = valueOf<int64_t>(this, "most", 3);
    Out = create_publisher<std_msgs::msg::Number>("out", 1);
  }
  void step(double V) {
    if (V > Low && V < High && V < Most)
      Out->publish(std_msgs::msg::Number());
  }

private:
  std::shared_ptr<rclcpp::Publisher<std_msgs::msg::Number>> Out;
  double Low, High;
  int64_t Most;
};

void run(double V) { Node().step(V); }
