//===- NodeRanges.cpp -----------------------------------------------------===//
#include "NodeRanges.h"

#include <algorithm>

namespace tpc {

static std::pair<uintptr_t, uintptr_t> rangeOf(const void *Object,
                                               uint64_t Size) {
  const auto Begin = reinterpret_cast<uintptr_t>(Object);
  return {Begin, Begin + std::max<uint64_t>(Size, 1)};
}

void NodeRanges::add(const std::string &Node, const void *Object,
                     uint64_t Size) {
  const auto Range = rangeOf(Object, Size);
  if (Ranges.size() < Most || Ranges.count(Range))
    Ranges[Range] = &*Names.insert(Node).first;
}

bool NodeRanges::replace(const std::string &Node, const void *Object,
                         uint64_t Size) {
  const auto [Begin, End] = rangeOf(Object, Size);
  bool IsOther = false;
  auto At = Ranges.lower_bound({Begin, 0});
  while (At != Ranges.end() && At->first.first < End) {
    IsOther |= *At->second != Node;
    At = Ranges.erase(At);
  }
  add(Node, Object, Size);
  return IsOther;
}

const std::string *NodeRanges::of(const void *Object) const {
  const auto Address = reinterpret_cast<uintptr_t>(Object);
  const std::string *Found = nullptr;
  uintptr_t Smallest = UINTPTR_MAX;
  for (const auto &[Range, Node] : Ranges) {
    if (Range.first > Address)
      break;
    if (Address < Range.second && Range.second - Range.first < Smallest) {
      Smallest = Range.second - Range.first;
      Found = Node;
    }
  }
  return Found;
}

} // namespace tpc
