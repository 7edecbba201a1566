"""A workspace before it is built: packages, colcon, CMake, the patch, the doctor."""
