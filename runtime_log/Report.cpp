//===- Report.cpp ---------------------------------------------------------===//
#include "Report.h"

#include <charconv>

namespace tpc {

static void append(std::string &Text, double X) {
  char Buffer[32];
  Text.append(Buffer, std::to_chars(Buffer, Buffer + sizeof(Buffer), X).ptr);
}

std::string format(const Report &R) {
  std::string Text;
  Text.reserve(128);
  Text += R.Key;
  Text += R.Result ? ",1,cmp:" : ",0,cmp:";
  append(Text, R.Compared);
  Text += ",thresh:";
  append(Text, R.Threshold);
  Text += R.Outcome ? ",res:1" : ",res:0";
  return Text;
}

} // namespace tpc
