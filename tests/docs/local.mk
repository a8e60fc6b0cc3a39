# tests/docs/local.mk - what the documents say, done.

TESTS += tests/docs/docs_commands.sh tests/docs/docs_pages.sh
dist_check_SCRIPTS += tests/docs/docs_commands.sh tests/docs/docs_pages.sh
EXTRA_DIST += tests/docs/excluded.txt
