# Two entry points for hands that type make; CMake does the work.
.PHONY: build test
build:
	./deploy/build
test:
	./deploy/test
