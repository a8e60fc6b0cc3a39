# tests/integration/ctl.mk - our programs, from outside.

TESTS += tests/integration/ctl_check.sh
dist_check_SCRIPTS += tests/integration/ctl_check.sh

# pccd-load, for seconds.
TESTS += tests/integration/load_check.sh
dist_check_SCRIPTS += tests/integration/load_check.sh
