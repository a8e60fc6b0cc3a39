# tests/model/local.mk - the protocols as models, searched by spin where it is installed.

TESTS += tests/model/check_models.sh
