.PHONY: demo demo-water demo-navigation test test-llvm22 fuzz setup bench lint help
PYTHON = .venv/bin/python

demo: setup   ## a robot with a wrong parameter, and its name
	$(PYTHON) examples/image_capture/demo.py --out out/demo

demo-water: setup  ## the same with a robot in Python and C++
	$(PYTHON) examples/water_sampler/demo.py --out out/demo-water

demo-navigation: setup  ## the same with a ground robot in Python and C++, its controller a plugin
	$(PYTHON) examples/navigation/demo.py --out out/demo-navigation

test: setup   ## all tests: passes, Python, a real ROS graph
	tools/test

fuzz: setup   ## a thousand random modules and programs; more: tools/fuzz --help
	tools/fuzz

test-llvm22:  ## the passes and their tests with LLVM 22, in build-22
	tools/test-llvm22

setup:        ## packages, .venv, passes; quick when done before
	@tools/setup

lint:         ## what CI asks of the sources
	tools/lint

bench: setup  ## figures of cost and speed, one line each
	tools/bench

help:         ## this list
	@sed -n 's/^\([a-z0-9-]*\):.*## */\1\t/p' Makefile | expand -t 18
