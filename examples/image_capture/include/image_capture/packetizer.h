// Cuts data into packets that the radio can carry.
#ifndef IMAGE_CAPTURE_PACKETIZER_H
#define IMAGE_CAPTURE_PACKETIZER_H

#include <cstdint>
#include <deque>
#include <vector>

#include <image_capture/Packet.h>
#include <ros/ros.h>

namespace image_capture {

class Packetizer {
public:
  explicit Packetizer(ros::NodeHandle &private_nh);

  /// Queues `data` for the given stream of Packet.msg.
  void push(std::uint8_t stream, const std::vector<std::uint8_t> &data,
            const ros::Time &stamp);
  bool empty() const { return queue_.empty(); }
  Packet pop();
  unsigned dropped() const { return dropped_; }

private:
  void add(std::uint8_t stream, std::vector<std::uint8_t> part, bool last,
           const ros::Time &stamp);

  std::deque<Packet> queue_;
  int max_pkt_size_;
  int max_queue_length_;
  std::uint32_t sequence_ = 0;
  unsigned dropped_ = 0;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_PACKETIZER_H
