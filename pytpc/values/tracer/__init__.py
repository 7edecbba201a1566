"""A program for roslaunch's Python, alone in its folder: Python looks for modules there first."""
