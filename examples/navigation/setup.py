"""For catkin_python_setup: where the modules of the mission are."""

from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["navigation"], package_dir={"": "src"}))
