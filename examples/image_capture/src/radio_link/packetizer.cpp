#include "image_capture/packetizer.h"

#include <utility>

namespace image_capture {

Packetizer::Packetizer(ros::NodeHandle &private_nh) {
  private_nh.param("max_pkt_size", max_pkt_size_, 512);
  private_nh.param("max_queue_length", max_queue_length_, 400);
}

void Packetizer::push(std::uint8_t stream,
                      const std::vector<std::uint8_t> &data,
                      const ros::Time &stamp) {
  auto begin = data.begin();
  int remaining = static_cast<int>(data.size());
  while (remaining > max_pkt_size_) {
    add(stream, {begin, begin + max_pkt_size_}, false, stamp);
    begin += max_pkt_size_;
    remaining -= max_pkt_size_;
  }
  add(stream, {begin, data.end()}, true, stamp);
}

void Packetizer::add(std::uint8_t stream, std::vector<std::uint8_t> part,
                     bool last, const ros::Time &stamp) {
  Packet packet;
  packet.header.stamp = stamp;
  packet.stream = stream;
  packet.sequence = sequence_++;
  packet.last = last;
  packet.data = std::move(part);
  queue_.push_back(packet);
  // Old data is worth less than new data.
  if (static_cast<int>(queue_.size()) > max_queue_length_) {
    queue_.pop_front();
    ++dropped_;
  }
}

Packet Packetizer::pop() {
  Packet packet = queue_.front();
  queue_.pop_front();
  return packet;
}

} // namespace image_capture
