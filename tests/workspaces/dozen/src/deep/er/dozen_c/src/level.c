#include "level.h"

int enough(const struct level *level, double value) { return value >= level->least; } /* TPC least */
