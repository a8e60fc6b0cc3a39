# tests/unit/local.mk
include $(top_srcdir)/tests/unit/ctl.mk
