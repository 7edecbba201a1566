"""For catkin_python_setup: where the observer's modules are."""

from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["simulated_world"], package_dir={"": "src"}))
