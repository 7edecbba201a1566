#include <dozen_libs/gate.h>
#include <dozen_libs/watch.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "libs_node");
  ros::NodeHandle handle;
  Gate gate(handle);
  const double most = handle.param("most", 4.0);
  for (int i = 0; i < 8; ++i)
    gate.offer(clamped(i, most));
  watch(1.0);
}
