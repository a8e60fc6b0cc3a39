# tests/local.mk - one fragment a folder; each adds its programs to check_PROGRAMS and TESTS.

include $(top_srcdir)/tests/support/local.mk
include $(top_srcdir)/tests/support/scenes.mk
include $(top_srcdir)/tests/unit/local.mk
include $(top_srcdir)/tests/determinism/local.mk
include $(top_srcdir)/tests/property/local.mk
include $(top_srcdir)/tests/truth/local.mk
include $(top_srcdir)/tests/fault/local.mk
include $(top_srcdir)/tests/fuzz/local.mk
include $(top_srcdir)/tests/proto/local.mk
include $(top_srcdir)/tests/model/local.mk
include $(top_srcdir)/tests/abi/local.mk
include $(top_srcdir)/tests/integration/local.mk
include $(top_srcdir)/tests/cpp/local.mk
include $(top_srcdir)/tests/ipc/local.mk
include $(top_srcdir)/tests/planner/local.mk
include $(top_srcdir)/tests/mpi/local.mk
include $(top_srcdir)/tests/zoo/local.mk
include $(top_srcdir)/tests/python/local.mk
include $(top_srcdir)/tests/blender/local.mk
include $(top_srcdir)/tests/files/local.mk
include $(top_srcdir)/tests/inspect/local.mk
include $(top_srcdir)/tests/docs/local.mk
include $(top_srcdir)/tests/style/local.mk
