# tests/unit/local.mk
include $(top_srcdir)/tests/unit/client.mk
include $(top_srcdir)/tests/unit/ctl.mk
include $(top_srcdir)/tests/unit/load.mk
include $(top_srcdir)/tests/unit/server.mk
include $(top_srcdir)/tests/unit/engine.mk
include $(top_srcdir)/tests/unit/oracle.mk
include $(top_srcdir)/tests/unit/record.mk
