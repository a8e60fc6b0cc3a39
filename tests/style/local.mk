# tests/style/local.mk - the rules of CONTRIBUTING.md that a script can check.

style_tests = \
    tests/style/test_style_files.sh \
    tests/style/test_style_rooms.sh \
    tests/style/test_style_words.sh
dist_check_SCRIPTS += $(style_tests)
TESTS += $(style_tests)
EXTRA_DIST += tests/style/words.txt
