// What the tests with the real headers of ROS include, as far as it is installed.
#include <ros/ros.h>
#if __has_include(<dynamic_reconfigure/server.h>)
#include <dynamic_reconfigure/server.h>
#endif
