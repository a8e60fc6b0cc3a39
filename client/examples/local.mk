# client/examples/local.mk - small programs, built and run by make check.
