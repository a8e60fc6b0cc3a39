# tests/inspect/local.mk - the page of pccdctl inspect; in a browser where chromium and
# chromium-driver are installed, else that part is skipped by name.

TESTS += tests/inspect/test_inspect_page.sh tests/inspect/test_make_page.sh
