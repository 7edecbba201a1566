// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A library that gets an object can call its virtual functions and the
// functions stored in it: they see a member before it is overwritten. The
// library calls nothing that it does not get.
#include <functional>
#include <memory>
#include <ros/ros.h>

struct Part {
  virtual ~Part();
  virtual void update();
  void refresh();
};
struct Any {
  virtual ~Any();
};
struct Plain {
  double Value;
};
void process(Part &);
void each(const std::function<void()> &);
void each(void (*)());
void look(Plain &);
void processShared(const std::shared_ptr<struct Node> &);

// CHECK: comparisons of {{.*}}: 7
struct Node : Part {
  ros::Publisher Out;
  double Virtual, ByBase, Shared, Found, Nothing, Another;
  double A = 0, B = 0, C = 0, D = 0, E = 0, I = 0;
  explicit Node(ros::NodeHandle &Handle);
  void send(double Value);
  void update() override { send(A + B + C + D + E + I); }
  void virtualFunction(double V);
  void byBase(double V);
  void shared(double V, const std::shared_ptr<Node> &Self);
  void found(double V, Any &Whatever);
  void nothing(double V, Plain &P);
};

struct Quiet : Part {
  double Count = 0;
  void update() override { ++Count; }
};

double UnnamedLimit;
namespace {
struct Unnamed : Part {
  ros::Publisher Out;
  double Last = 0;
  void update() override {
    std_msgs::Number Message;
    Message.data = Last;
    Out.publish(Message);
  }
  void step(double V) {
    // CHECK-DAG: parameter 'unnamed' {{.*}} at [[#@LINE+1]]:14
    Last = V > UnnamedLimit ? 1 : 0;
    process(*this);
    Last = 0;
  }
};
} // namespace

double Function, Pointer, Unkept;
double F, G, H;
ros::Publisher Out;

Node::Node(ros::NodeHandle &Handle) {
  Handle.param("virtual", Virtual, 1.0);
  Handle.param("by_base", ByBase, 1.0);
  Handle.param("shared", Shared, 1.0);
  Handle.param("found", Found, 1.0);
  Handle.param("nothing", Nothing, 1.0);
  Handle.param("another", Another, 1.0);
  Handle.param("unnamed", UnnamedLimit, 1.0);
  Handle.param("function", Function, 1.0);
  Handle.param("pointer", Pointer, 1.0);
  Handle.param("unkept", Unkept, 1.0);
}

void Node::send(double Value) {
  std_msgs::Number Message;
  Message.data = Value;
  Out.publish(Message);
}

void Node::virtualFunction(double V) {
  // CHECK-DAG: parameter 'virtual' {{.*}} at [[#@LINE+1]]:9
  A = V > Virtual ? 1 : 0;
  process(*this);
  A = 0;
}

void Node::byBase(double V) {
  // CHECK-DAG: parameter 'by_base' {{.*}} at [[#@LINE+1]]:9
  B = V > ByBase ? 1 : 0;
  refresh();
  B = 0;
}

void Node::shared(double V, const std::shared_ptr<Node> &Self) {
  // CHECK-DAG: parameter 'shared' {{.*}} at [[#@LINE+1]]:9
  C = V > Shared ? 1 : 0;
  processShared(Self);
  C = 0;
}

void Node::found(double V, Any &Whatever) {
  // CHECK-DAG: parameter 'found' {{.*}} at [[#@LINE+1]]:9
  I = V > Found ? 1 : 0;
  if (auto *Known = dynamic_cast<Part *>(&Whatever))
    process(*Known);
  I = 0;
}

void Node::nothing(double V, Plain &P) {
  D = V > Nothing ? 1 : 0;
  look(P);
  D = 0;
}

static void another(Node &N, Quiet &Other, double V) {
  N.E = V > N.Another ? 1 : 0;
  process(Other);
  N.E = 0;
}

static void sendF() {
  std_msgs::Number Message;
  Message.data = F;
  Out.publish(Message);
}
static void sendG() {
  std_msgs::Number Message;
  Message.data = G + H;
  Out.publish(Message);
}

void function(double V) {
  std::function<void()> Kept = [] { sendF(); };
  // CHECK-DAG: parameter 'function' {{.*}} at [[#@LINE+1]]:9
  F = V > Function ? 1 : 0;
  each(Kept);
  F = 0;
}

void pointer(double V, bool Odd) {
  void (*Kept)() = Odd ? sendF : sendG;
  // CHECK-DAG: parameter 'pointer' {{.*}} at [[#@LINE+1]]:9
  G = V > Pointer ? 1 : 0;
  each(Kept);
  G = 0;
}

void unkept(double V, Plain &P) {
  H = V > Unkept ? 1 : 0;
  look(P);
  H = 0;
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  auto N = std::make_shared<Node>(Handle);
  Quiet Other;
  Unnamed Hidden;
  Hidden.step(1);
  Plain P;
  N->virtualFunction(1);
  N->byBase(1);
  N->shared(1, N);
  Any Whatever;
  N->found(1, Whatever);
  N->nothing(1, P);
  another(*N, Other, 1);
  function(1);
  pointer(1, Argc > 1);
  unkept(1, P);
}
