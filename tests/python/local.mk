# tests/python/local.mk - the Python client; skipped by name without python3-numpy and
# python3-msgpack.

python_tests = \
    tests/python/test_python_client.sh \
    tests/python/test_python_use.sh
TESTS += $(python_tests)
dist_check_SCRIPTS += $(python_tests)
EXTRA_DIST += \
    tests/python/check_client.py \
    tests/python/check_link.py \
    tests/python/check_scenes.py \
    tests/python/check_wire.py \
    tests/python/find.sh \
    tests/python/support.py \
    tests/python/tap.py
