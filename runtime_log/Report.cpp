//===- Report.cpp ---------------------------------------------------------===//
#include "Report.h"

#include <charconv>

namespace tpc {

static void append(std::string &Text, double X) {
  char Buffer[32];
  Text.append(Buffer, std::to_chars(Buffer, Buffer + sizeof(Buffer), X).ptr);
}

static void append(std::string &Text, const char *Name, double X) {
  Text += Name;
  append(Text, X);
}

static void append(std::string &Text, const char *Name, uint64_t X) {
  Text += Name;
  Text += std::to_string(X);
}

std::string seconds(int64_t Ns, int Decimals) {
  constexpr uint64_t Second = 1'000'000'000;
  uint64_t Size = Ns < 0 ? -static_cast<uint64_t>(Ns) : Ns;
  std::string Fraction = std::to_string(Second + Size % Second);
  return (Ns < 0 ? "-" : "") + std::to_string(Size / Second) + "." +
         Fraction.substr(1, Decimals);
}

const char *text(DropReason R) {
  switch (R) {
  case DropReason::SiteCap:
    return "site";
  case DropReason::ProcessCap:
    return "process";
  case DropReason::Nested:
    return "nested";
  case DropReason::Stopped:
    return "stopped";
  }
  return "";
}

std::string format(const Report &R) {
  std::string Text;
  Text.reserve(128);
  Text += R.Key;
  Text += R.Result ? ",1,cmp:" : ",0,cmp:";
  append(Text, R.Compared);
  append(Text, ",thresh:", R.Threshold);
  Text += R.Outcome ? ",res:1" : ",res:0";
  return Text;
}

std::string format(const Summary &S) {
  std::string Text =
      format(Report{S.Key, S.Result, S.Compared, S.Threshold, S.Outcome});
  double Usable = static_cast<double>(S.Count - S.Odd);
  append(Text, ",count:", S.Count);
  append(Text, ",flops:", S.Flops);
  append(Text, ",diff:", S.DiffMin);
  append(Text, ";", S.DiffMax);
  append(Text, ";", S.DiffSum / Usable);
  append(Text, ",abs:", S.AbsSum / Usable);
  append(Text, ",range:", S.Low);
  append(Text, ";", S.High);
  append(Text, ",far:", S.Far);
  append(Text, ",odd:", S.Odd);
  Text += ",span:";
  Text += seconds(S.BeginRos, 9);
  Text += ';';
  Text += seconds(S.EndRos, 9);
  if (S.IsLight && S.Seen != S.Count)
    append(Text, ",seen:", S.Seen);
  if (S.IsAbout)
    Text += ",about";
  return Text;
}

/// Whether the numbers of \p S follow from the last evaluation and the counts.
static bool isUniform(const Summary &S) {
  return !S.Odd && S.HasOneThreshold && S.Least == S.Most;
}

std::string formatShort(const Summary &S) {
  std::string Text = S.Key;
  Text += ',';
  Text += static_cast<char>('0' + S.Result + 2 * S.Outcome);
  append(Text, ",", S.Compared);
  append(Text, ",", S.Threshold);
  append(Text, ",", S.Count);
  if (S.Flops)
    append(Text, ",f:", S.Flops);
  uint64_t Usable = S.Count - S.Odd;
  if (Usable && !isUniform(S)) {
    auto Number = static_cast<double>(Usable);
    if (S.HasOneThreshold) {
      append(Text, ",c:", S.Least);
      append(Text, ";", S.Most);
    } else {
      append(Text, ",d:", S.DiffMin);
      append(Text, ";", S.DiffMax);
      append(Text, ";", S.Low);
      append(Text, ";", S.High);
    }
    append(Text, ",m:", S.DiffSum / Number);
    if (S.DiffMin < 0 && S.DiffMax > 0)
      append(Text, ";", S.AbsSum / Number);
    // Otherwise it follows from the extremes.
    if (S.Far != Usable)
      append(Text, ",w:", S.Far);
  }
  if (S.Odd)
    append(Text, ",o:", S.Odd);
  if (S.Seen != S.Count)
    append(Text, ",s:", S.Seen);
  if (S.IsAbout)
    Text += ",e";
  return Text;
}

std::string format(const Dropped &D) {
  std::string Text = D.Key;
  append(Text, ",count:", D.Count);
  append(Text, ",flops:", D.Flops);
  Text += ",why:";
  Text += text(D.Why);
  return Text;
}

} // namespace tpc
