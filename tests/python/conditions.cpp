#define LIMITED(x, limit) ((x) > (limit))
#define RETURN_IF_OVER(x, limit) \
  if ((x) > (limit))             \
  return
struct Own {
  bool operator>(const Own &) const;
};
struct Node {
  double low_, high_;
  bool use_;
  int most_;
  Own own_;
  void publish();
  double pick(bool);
};
template <class T> const T &larger(const T &, const T &);

void joined(Node &n, double v) {
  if (v > n.low_ &&
      (v < n.high_ ||  // ) not the end
       n.use_)) {
    n.publish();
  } else if (!n.use_)
    n.publish();
}
void loops(Node &n, double v) {
  while (v * 2 > n.low_) n.publish();
  for (int i = 0; i < n.most_; ++i) n.publish();
  for (int i = n.most_ > 3 ? 1 : 2; i < 9; ++i) n.publish();
  for (;;) n.use_ = v == n.low_;
  do { n.publish(); } while (v > n.low_ || n.use_);
}
bool values(Node &n, double v) {
  double w = n.pick(v > n.low_) ? 1 : 2;
  bool near = v < n.high_ && w > 1;
  n.use_ = v > n.low_;
  switch (n.most_) { default: n.publish(); }
  return larger(v, n.low_) > 2 || n.own_ > n.own_ || near;
}
void macros(Node &n, double v) {
  if (LIMITED(v, n.low_) && n.use_) n.publish();
  RETURN_IF_OVER(v, n.high_);
}
void declared(Node &n, double v) {
  if (bool b = v > n.low_; b) n.publish();
  if (bool b = v > n.low_) n.publish();
  if (n.use_) n.most_ = v > n.low_;
  if (n.pick([&] { if (v != n.high_) return 1; return 2; }())) n.publish();
}
double far(Node &n, double v) {
  double d = larger(v, n.low_);
  return d;
}
