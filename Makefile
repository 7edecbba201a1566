.PHONY: setup package test-package audit demo demo-water demo-navigation demo-ros2 check test test-llvm22 format lint tidy fuzz bench coverage docs docs-serve pictures help
PYTHON = .venv/bin/python

help:         ## this list
	@sed -n 's/^\([a-z0-9-]*\):.*## */\1\t/p' Makefile | expand -t 18

setup:        ## what a user needs: packages, .venv, passes; quick when done before
	@tools/setup

package:      ## the wheel and the Debian package, in out/
	@tools/setup
	tools/package

demo:         ## a robot with a wrong parameter, and its name
	@tools/setup demo
	$(PYTHON) examples/image_capture/demo.py --out out/demo

demo-water:   ## the same with a robot in Python and C++
	@tools/setup demo
	$(PYTHON) examples/water_sampler/demo.py --out out/demo-water

demo-navigation: ## the same with a ground robot in Python and C++, its controller a plugin
	@tools/setup demo
	$(PYTHON) examples/navigation/demo.py --out out/demo-navigation

demo-ros2:    ## the first robot as nodes of rclpy, on a ROS 2 graph; brings its own ROS 2
	@tools/setup ros2
	$(PYTHON) examples/image_capture_ros2/demo.py --out out/demo-ros2

check:        ## in two minutes: lint, the passes' tests, the Python tests that your change touches
	@tools/setup test
	@tools/check

test:         ## all tests: passes, Python, a real ROS graph
	@tools/setup test
	tools/test

test-llvm22:  ## the passes and their tests with LLVM 22, in build-22
	tools/test-llvm22

docs:         ## the docs as a site with a search, in out/site: open out/site/index.html
	@tools/setup docs
	@tools/build-site

docs-serve:   ## the same, and serves it on http://127.0.0.1:8000 until Ctrl-C
	@tools/setup docs
	@tools/build-site
	@.venv-docs/bin/python -m http.server --bind 127.0.0.1 --directory out/site 8000

pictures:     ## draws docs/images again, from missions that it flies: twenty minutes the first time
	@tools/setup test
	$(PYTHON) examples/image_capture/demo.py --out out/demo
	tools/draw-pictures

test-package: ## installs both packages in empty places and tries them there: half an hour
	@tools/setup test
	tools/test-package

audit:        ## known faults of the locked Python packages, where the database is reached
	tools/audit

format:       ## the sources in the form that lint asks for
	@tools/setup test
	@tools/format

lint:         ## what CI asks of the sources
	@tools/setup test
	tools/lint

tidy:         ## clang-tidy on the C++ sources: half an hour
	@tools/setup test
	tools/tidy

coverage:     ## how much of the Python side its tests run
	@tools/setup test
	tools/coverage

fuzz:         ## a thousand random modules and programs; more: tools/fuzz --help
	@tools/setup test
	tools/fuzz

bench:        ## figures of cost and speed, one line each
	@tools/setup test
	tools/bench
