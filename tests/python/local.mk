# tests/python/local.mk - the Python module; skipped by name without python3-numpy and
# python3-msgpack.

python_tests = \
    tests/python/test_python_client.sh \
    tests/python/test_python_files.sh \
    tests/python/test_python_use.sh \
    tests/python/test_python_vtk.sh \
    tests/python/test_python_wheel.sh
TESTS += $(python_tests)
