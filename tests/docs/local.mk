# tests/docs/local.mk - what the documents say, done.

TESTS += tests/docs/docs_commands.sh tests/docs/docs_pages.sh tests/docs/test_site.sh
