// Thresholds in arrays from new[], malloc and calloc, also in a unique_ptr and
// as bytes.
#include <cstdlib>
#include <cstring>
#include <memory>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

class Bands {
public:
  explicit Bands(ros::NodeHandle &nh)
      : pnh_("~"), lower_(new double[kBands]), upper_(new double[kBands]) {
    double step;
    pnh_.param("step", step, 1.5);
    for (int i = 0; i < kBands; ++i)
      lower_[i] = step;
    pnh_.param("ceiling", upper_[0], 6.0);
    levels_ = static_cast<int *>(std::calloc(kBands, sizeof(int)));
    int level;
    pnh_.param("level", level, 3);
    for (int *at = levels_; at != levels_ + kBands; ++at)
      *at = level;
    shown_ = static_cast<double *>(std::malloc(kBands * sizeof(double)));
    pnh_.param("shown", shown_[1], 2.0);
    cells_ = new unsigned char[kCells];
    std::memset(cells_, 0, kCells);
    int occupied;
    pnh_.param("occupied", occupied, 4);
    for (int i = 1; i < kCells; i += 2)
      cells_[i] = occupied;
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    level_pub_ = nh.advertise<std_msgs::Int32>("level", 1000);
    sub_ = nh.subscribe("input", 1000, &Bands::onInput, this);
  }
  ~Bands() {
    delete[] upper_;
    delete[] cells_;
    std::free(levels_);
    std::free(shown_);
  }

private:
  int cellOf(double value) const {
    return std::abs(static_cast<int>(value)) % kCells;
  }
  unsigned char costAt(int cell) const { return cells_[cell]; }

  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    int band = cellOf(msg->data) % kBands;
    if (msg->data < lower_[band])
      return;
    if (msg->data > *upper_)
      return;
    if (msg->data > shown_[1])
      ROS_INFO("more than is shown");
    std_msgs::Int32 level;
    if (band >= levels_[band])
      level.data = band;
    level_pub_.publish(level);
    if (msg->data > costAt(cellOf(msg->data)))
      pub_.publish(msg);
  }

  static constexpr int kBands = 4, kCells = 10;
  ros::NodeHandle pnh_;
  std::unique_ptr<double[]> lower_;
  double *upper_, *shown_;
  int *levels_;
  unsigned char *cells_;
  ros::Publisher pub_, level_pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_heap_arrays");
  ros::NodeHandle nh;
  Bands bands(nh);
  ros::spin();
  return 0;
}
