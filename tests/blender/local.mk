# tests/blender/local.mk - the add-on for Blender; skipped by name where there is no blender.

blender_tests = \
    tests/blender/test_blender_addon.sh \
    tests/blender/test_blender_logic.sh
TESTS += $(blender_tests)
