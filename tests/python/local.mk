# tests/python/local.mk - the Python module; skipped by name without python3-numpy and
# python3-msgpack.

python_tests = \
    tests/python/test_python_client.sh \
    tests/python/test_python_files.sh \
    tests/python/test_python_use.sh \
    tests/python/test_python_vtk.sh \
    tests/python/test_python_wheel.sh
TESTS += $(python_tests)
dist_check_SCRIPTS += $(python_tests)
EXTRA_DIST += \
    tests/python/check_abi.py \
    tests/python/check_arrays.py \
    tests/python/check_client.py \
    tests/python/check_files.py \
    tests/python/check_link.py \
    tests/python/check_misuse.py \
    tests/python/check_batch.py \
    tests/python/check_near.py \
    tests/python/check_raw.py \
    tests/python/check_scenes.py \
    tests/python/check_thick.py \
    tests/python/check_weld.py \
    tests/python/check_vtk.py \
    tests/python/find.sh \
    tests/python/raw_client.py \
    tests/python/support.py \
    tests/python/tap.py
