#pragma once
#include <ros/publisher.h>

void step(const ros::Publisher &publisher, double value, double limit);
