"""Link units of any size, like those of real stacks: classes that hold each other, set, call and
configure each other, some virtual, with local structs handed on by reference and with containers.

Each cell of ``CELL`` functions is a component of its own that publishes and reads parameters;
components call their neighbours and a few functions that all share. The same arguments give the
same text.
"""

# ruff: noqa: E501
# (Lines of C++ stay whole.)

from __future__ import annotations

import random

CELL = 20
"""Functions in one component."""

SHARED = """\
#include <ros/ros.h>
#include <string>
struct Vec { double x, y, z; };
struct Limits { double low, high; int count; Vec offset; };
void log(const char *text, double value);
double clampTo(double value, const Limits &l) {
  if (value < l.low) return l.low;
  if (value > l.high) return l.high;
  return value;
}
double norm(const Vec &v) { return v.x * v.x + v.y * v.y + v.z * v.z; }
void scale(Vec &v, double by) { v.x *= by; v.y *= by; v.z *= by; }
"""

STAGE = "struct Stage{g} {{ virtual ~Stage{g}() {{}} virtual double run(double in) = 0; Stage{g} *after = nullptr; }};\n"
NEW = "  {{ auto *p = new Part{n}(nh); p->after = first{g}; first{g} = p; }}\n"
PARTS_OF_STAGE = 25
"""Classes that derive from one base."""

COMPONENT = """\
struct Item{n} {{ double weight; Item{n} *next; Limits *limits; }};
struct Part{n} : Stage{g} {{
  Limits limits; Vec pose; Item{n} *items = nullptr; Part{m} *peer = nullptr;
  double gain, bias; int mode; bool active; double history[8]; unsigned filled = 0;
  ros::Publisher pub;
  explicit Part{n}(ros::NodeHandle &nh);
  double run(double in) override;
  void configure(ros::NodeHandle &nh);
  void setGain(double g) {{ gain = g; }}
  double getGain() const {{ return gain; }}
  void setPeer(Part{m} *p) {{ peer = p; }}
  bool ready() const; bool inside(double v) const; void push(double v); double mean() const;
  void move(const Vec &by); Vec target() const; void add(Item{n} *i); double total() const;
  void decide(double v); void emit(double v); int classify(double v); void reset(); void step(double v);
  void adapt(Limits &l, double v);
}};
"""

BODY = """\
Part{n}::Part{n}(ros::NodeHandle &nh) : limits(), pose(), gain(1), bias(0), mode(0), active(true) {{ configure(nh); }}
void Part{n}::configure(ros::NodeHandle &nh) {{
  nh.param<double>("part{n}/low", limits.low, {a});
  nh.param<double>("part{n}/high", limits.high, {b});
  double g; nh.param<double>("part{n}/gain", g, {a}); setGain(g * 2);
  nh.param<int>("part{n}/mode", mode, {k});
  nh.param<bool>("part{n}/active", active, true);
  pub = nh.advertise<std_msgs::Number>("part{n}", 1);
}}
double Part{n}::run(double in) {{ step(in); return after ? after->run(in * gain) : in; }}
bool Part{n}::ready() const {{ return active && filled > {k}; }}
bool Part{n}::inside(double v) const {{ return v > limits.low && v < limits.high; }}
void Part{n}::push(double v) {{ history[filled % 8] = v; ++filled; if (v > limits.high) log("part{n}", v); }}
double Part{n}::mean() const {{ double s = 0; for (unsigned i = 0; i < 8; ++i) s += history[i]; return s / 8; }}
void Part{n}::move(const Vec &by) {{ Vec v = by; scale(v, gain); if (norm(v) > bias) {{ pose.x += v.x; pose.y += v.y; }} }}
Vec Part{n}::target() const {{ Vec t = pose; if (peer && peer->ready()) t = peer->pose; scale(t, getGain()); return t; }}
void Part{n}::add(Item{n} *i) {{ i->next = items; i->limits = &limits; items = i; }}
double Part{n}::total() const {{ double s = 0; for (Item{n} *i = items; i; i = i->next) {{ if (i->weight > i->limits->low) s += i->weight; }} return s; }}
int Part{n}::classify(double v) {{ switch (mode) {{ case 0: return v > bias; case 1: return v < limits.low ? -1 : 1; default: return {k}; }} }}
void Part{n}::reset() {{ filled = 0; for (double &h : history) h = 0; }}
void Part{n}::adapt(Limits &l, double v) {{ Limits copy = l; copy.count++; if (v > copy.high) copy.high = v; l = copy; }}
void Part{n}::emit(double v) {{ std_msgs::Number m; m.data = clampTo(v, limits); pub.publish(m); }}
void Part{n}::decide(double v) {{
  int c = classify(v);
  if (c > 0 && inside(v)) emit(v); else if (c < 0) push(v);
  while (filled > 100) {{ reset(); }}
  Vec t = target(); move(t); if (total() > gain) emit(t.x);
}}
void Part{n}::step(double v) {{
  if (!ready()) {{ push(v); return; }}
  if (peer) {{ peer->setGain(v); adapt(peer->limits, v); if (v > peer->getGain()) peer->push(v); }}
  for (int i = 0; i < mode; ++i) {{ if (mean() > bias) decide(v); else bias = v; }}
}}
"""


def large_unit(functions: int, seed: int = 1) -> str:
    """The C++ text of a unit of about ``functions`` functions, on the stub of ``ros/ros.h``."""
    rng = random.Random(seed)
    count = max(1, functions // CELL)
    parts = [SHARED]
    stages = range((count + PARTS_OF_STAGE - 1) // PARTS_OF_STAGE)
    parts += [STAGE.format(g=g) for g in stages]
    parts += [f"struct Part{n};\n" for n in range(count)]
    numbers = [
        {
            "n": n,
            "m": rng.randrange(count),
            "a": rng.randint(1, 9),
            "b": rng.randint(10, 99),
            "k": n % 5,
            "g": n // PARTS_OF_STAGE,
        }
        for n in range(count)
    ]
    parts += [COMPONENT.format(**one) for one in numbers]
    parts += [BODY.format(**one) for one in numbers]
    parts.append("int main() {\n  ros::NodeHandle nh;\n")
    parts += [f"  Stage{g} *first{g} = nullptr;\n" for g in stages]
    for one in numbers:
        parts.append(NEW.format(**one))
    parts += [f"  first{g}->run(1.0);\n" for g in stages]
    parts.append("}\n")
    return "".join(parts)
