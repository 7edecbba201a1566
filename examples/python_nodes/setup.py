"""Tells catkin where the modules that several nodes share are."""

from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["python_nodes"], package_dir={"": "src"}))
