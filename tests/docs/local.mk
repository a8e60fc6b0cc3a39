# tests/docs/local.mk - what the documents say, done.

TESTS += tests/docs/docs_commands.sh tests/docs/docs_pages.sh tests/docs/test_site.sh
dist_check_SCRIPTS += tests/docs/docs_commands.sh tests/docs/docs_pages.sh tests/docs/test_site.sh
EXTRA_DIST += tests/docs/check_site.py tests/docs/excluded.txt
