// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A struct of parameters that generated code fills: it declares and reads them
// through an interface of the node, whose class is not in the debug
// information, and the program reads a copy of the struct. Then a helper that
// declares a parameter whose name is put together.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

struct Params {
  double Speed = 1;
  struct Limits {
    double Low = 2;
  } Limit;
  std::string Mode;
};

class Listener {
public:
  Listener(rclcpp::Node &Of, const std::string &Prefix)
      : Prefix(Prefix), Access(Of.get_node_parameters_interface()) {
    Params New = Known;
    // CHECK-DAG: NodeParametersInterface::declare_parameter 'arm.speed' {{.*}} at [[#@LINE+1]]
    Access->declare_parameter(Prefix + "speed",
                              rclcpp::ParameterValue(New.Speed));
    rclcpp::Parameter P;
    P = Access->get_parameter(Prefix + "speed");
    New.Speed = P.as_double();
    P = Access->get_parameter(Prefix + "limit.low");
    New.Limit.Low = P.as_double();
    Access->get_parameter(Prefix + "mode", P);
    New.Mode = P.as_string();
    Known = New;
  }
  Params get() const { return Known; }

private:
  std::string Prefix;
  std::shared_ptr<rclcpp::node_interfaces::NodeParametersInterface> Access;
  Params Known;
};

template <typename N>
void declareOnce(N Of, const std::string &Name,
                 const rclcpp::ParameterValue &Default) {
  if (!Of->has_parameter(Name))
    Of->declare_parameter(Name, Default);
}

// CHECK-DAG: comparisons of {{.*}}: 4
void run(rclcpp::Node *Of, rclcpp::Publisher<Number> &Out,
         const std::string &Plugin, double V) {
  Listener L(*Of, "arm.");
  Params P = L.get();
  // CHECK-DAG: parameter 'arm.speed' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > P.Speed)
    Out.publish(Number());
  // CHECK-DAG: parameter 'arm.limit.low' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > P.Limit.Low)
    Out.publish(Number());
  // CHECK-DAG: parameter 'arm.mode' relation == {{.*}} at [[#@LINE+1]]:14
  if (P.Mode == "fast")
    Out.publish(Number());
  double Gain = 0;
  declareOnce(Of, Plugin + ".gain", rclcpp::ParameterValue(0.5));
  Of->get_parameter(Plugin + ".gain", Gain);
  // CHECK-DAG: parameter '<dynamic>.gain' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Gain)
    Out.publish(Number());
}
