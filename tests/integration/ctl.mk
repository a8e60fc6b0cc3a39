# tests/integration/ctl.mk - pccdctl, from outside.

TESTS += tests/integration/ctl_check.sh
dist_check_SCRIPTS += tests/integration/ctl_check.sh
