//===- StringPublish.cpp - A std_msgs/String for each report
//---------------===//
//
// What is written in an afternoon: the line of a report (docs/reference/formats.md) on a topic. The numbers
// are made into text as fast as the standard library can.
//
//===----------------------------------------------------------------------===//
#include "ByHand.h"

#include <charconv>
#include <cstdio>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <string>

char Reporting = 1;

static void append(std::string &Text, double X) {
  char Buffer[32];
  Text.append(Buffer, std::to_chars(Buffer, Buffer + sizeof(Buffer), X).ptr);
}

void log_one(char *key, bool result, double cmp, double thresh, bool res) {
  static ros::NodeHandle Node;
  static ros::Publisher Out =
      Node.advertise<std_msgs::String>("/threshold_information", 10000);
  char Time[32];
  std::snprintf(Time, sizeof(Time), "%.7f,", ros::Time::now().toSec());
  std_msgs::String Message;
  Message.data.reserve(160);
  Message.data = Time;
  Message.data += key;
  Message.data += result ? ",1,cmp:" : ",0,cmp:";
  append(Message.data, cmp);
  Message.data += ",thresh:";
  append(Message.data, thresh);
  Message.data += res ? ",res:1" : ",res:0";
  Out.publish(Message);
}
