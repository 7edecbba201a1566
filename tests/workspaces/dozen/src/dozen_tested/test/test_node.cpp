#include <gtest/gtest.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

TEST(Node, publishesTheLastThatIsAllowed) {
  ros::NodeHandle handle;
  // The node has the parameter most, 9, and offers 1 to 7: of 2, 4, ..., 14 the last is 8.
  const double slack = handle.param("slack", 0.25);
  auto message = ros::topic::waitForMessage<std_msgs::Float64>("twice", handle, ros::Duration(20));
  ASSERT_TRUE(message != nullptr);
  EXPECT_NEAR(8.0, message->data, slack);
}

int main(int argc, char **argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "test_node");
  return RUN_ALL_TESTS();
}
