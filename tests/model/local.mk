# tests/model/local.mk - the protocols as models, searched by spin where it is installed.

dist_check_SCRIPTS += tests/model/check_models.sh
TESTS += tests/model/check_models.sh
EXTRA_DIST += tests/model/resume.pml tests/model/wakeup.pml
