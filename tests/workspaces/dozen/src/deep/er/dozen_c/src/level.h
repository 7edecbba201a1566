#ifndef LEVEL_H
#define LEVEL_H
struct level {
  double least;
};
int enough(const struct level *level, double value);
#endif
