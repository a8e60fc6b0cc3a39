# tests/cpp/local.mk - the header for C++, and what CMake is told.

TESTS += tests/cpp/test_cpp.sh
dist_check_SCRIPTS += tests/cpp/test_cpp.sh
EXTRA_DIST += tests/cpp/check.cc
