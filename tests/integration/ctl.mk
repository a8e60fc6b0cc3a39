# tests/integration/ctl.mk - our programs, from outside.

TESTS += tests/integration/ctl_check.sh

# Commands that look at a daemon.
TESTS += tests/integration/ctl_observe.sh

# pccd-load, for seconds.
TESTS += tests/integration/load_check.sh

# Files with odd names, on a disk that is full, and larger than what is in them.
TESTS += tests/integration/ctl_files.sh

TESTS += tests/integration/ctl_record.sh

# What is near in the meshes of files.
TESTS += tests/integration/ctl_near.sh tests/integration/ctl_see.sh tests/integration/ctl_sequence.sh \
    tests/integration/ctl_objects.sh
