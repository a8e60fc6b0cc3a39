# bench/local.mk - measurements; built by make bench, not by make check.
