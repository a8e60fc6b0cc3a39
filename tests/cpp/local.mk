# tests/cpp/local.mk - the header for C++, and what CMake is told.

TESTS += tests/cpp/test_cpp.sh
