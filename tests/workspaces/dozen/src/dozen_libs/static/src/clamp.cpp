#include <dozen_libs/gate.h>

double clamped(double value, double most) { return value > most ? most : value; } // TPC most
