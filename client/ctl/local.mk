# client/ctl/local.mk - pccdctl.

bin_PROGRAMS += pccdctl
noinst_LTLIBRARIES += libctl.la

# Everything but main, so that tests can link what they test.
libctl_la_SOURCES = \
    client/ctl/check_run.c client/ctl/check_run.h \
    client/ctl/cloth_scene.c client/ctl/cloth_scene.h \
    client/ctl/cmd_check.c \
    client/ctl/cmd_demo.c \
    client/ctl/cmd_ping.c \
    client/ctl/cmd_stats.c \
    client/ctl/cmd_trace.c \
    client/ctl/cmd_version.c \
    client/ctl/common.c client/ctl/ctl.h \
    client/ctl/contacts_csv.c client/ctl/contacts_csv.h \
    client/ctl/demo_picture.c client/ctl/demo_picture.h \
    client/ctl/error.c client/ctl/error.h \
    client/ctl/link.c client/ctl/link.h \
    client/ctl/meshfile.c client/ctl/meshfile.h \
    client/ctl/obj.c \
    client/ctl/picture.c client/ctl/picture.h \
    client/ctl/ply.c \
    client/ctl/ply_header.c client/ctl/ply_header.h \
    client/ctl/progress.c client/ctl/progress.h \
    client/ctl/raster.c client/ctl/raster.h \
    client/ctl/report.c client/ctl/report_json.c client/ctl/report.h \
    client/ctl/stats_threads.c client/ctl/stats_threads.h \
    client/ctl/statistics.c client/ctl/statistics.h \
    client/ctl/text.c client/ctl/text.h \
    client/ctl/trace_file.c client/ctl/trace_file.h
# -iquote: proto/limits.h must not stand in for the C library's <limits.h>.
ctl_cppflags = -iquote $(top_srcdir)/client/ctl -iquote $(top_srcdir)/client/lib \
    -iquote $(top_srcdir)/proto
libctl_la_CPPFLAGS = $(AM_CPPFLAGS) $(ctl_cppflags) $(JANSSON_CFLAGS) $(PNG_CFLAGS)

pccdctl_SOURCES = client/ctl/main.c
pccdctl_CPPFLAGS = $(libctl_la_CPPFLAGS)
# Of our own libraries it takes the static ones: build/pccdctl is then the program itself, not
# a script that starts it, and finds the daemon beside it as an installed one does.
pccdctl_LDFLAGS = $(AM_LDFLAGS) -static
pccdctl_LDADD = libctl.la libpccd.la $(JANSSON_LIBS) $(PNG_LIBS) $(LIBM)

# The manual page, where scdoc is installed.
EXTRA_DIST += client/ctl/pccdctl.1.scd
if HAVE_SCDOC
man1_MANS = client/ctl/pccdctl.1
CLEANFILES += client/ctl/pccdctl.1
client/ctl/pccdctl.1: client/ctl/pccdctl.1.scd
	$(AM_V_GEN)$(MKDIR_P) client/ctl && $(SCDOC) <$(top_srcdir)/client/ctl/pccdctl.1.scd >$@.tmp && \
	    mv $@.tmp $@
endif
