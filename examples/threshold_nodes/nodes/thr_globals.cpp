// Old style: free callbacks, everything global, the parameters in an array and
// a plain struct, the state set in one function and used in another.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int8.h>

enum { X_MIN, X_MAX, N_BOUNDS };
double bounds[N_BOUNDS];
struct {
  int max_violations;
  bool report_all;
} options;
int violations;
bool inside;
ros::Publisher *state_pub;

void checkBounds(double x) {
  inside = true;
  if (x < bounds[X_MIN])
    inside = false;
  if (x > bounds[X_MAX])
    inside = false;
}

void publishState() {
  std_msgs::Int8 state;
  if (inside) {
    if (!options.report_all)
      return;
    state.data = 0;
  } else {
    ++violations;
    state.data = violations > options.max_violations ? 2 : 1;
  }
  state_pub->publish(state);
}

void xCallback(const std_msgs::Float64::ConstPtr &x) {
  checkBounds(x->data);
  publishState();
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_globals");
  ros::NodeHandle nh, pnh("~");
  pnh.param("x_min", bounds[X_MIN], -5.0);
  pnh.param("x_max", bounds[X_MAX], 5.0);
  pnh.param("max_violations", options.max_violations, 10);
  pnh.param("report_all", options.report_all, false);
  ros::Publisher pub = nh.advertise<std_msgs::Int8>("output", 1000);
  state_pub = &pub;
  ros::Subscriber sub = nh.subscribe("input", 1000, xCallback);
  ros::spin();
  return 0;
}
