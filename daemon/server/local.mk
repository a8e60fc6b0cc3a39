# daemon/server/local.mk - program pccdd, from a library that the unit tests link too.

noinst_LTLIBRARIES += libserver.la
libserver_la_SOURCES = \
    daemon/server/activate.c daemon/server/activate.h \
    daemon/server/allow.c daemon/server/allow.h \
    daemon/server/call.h \
    daemon/server/bell.c daemon/server/bell.h \
    daemon/server/closer.c daemon/server/closer.h \
    daemon/server/compute.c daemon/server/compute.h \
    daemon/server/conn.c daemon/server/conn.h \
    daemon/server/crash.c daemon/server/crash.h \
    daemon/server/dispatch.c daemon/server/dispatch.h \
    daemon/server/enginemem.c daemon/server/enginemem.h \
    daemon/server/fairqueue.c daemon/server/fairqueue.h \
    daemon/server/handles.c daemon/server/handles.h \
    daemon/server/handlers_admin.c \
    daemon/server/handlers_frame.c \
    daemon/server/handlers_hello.c \
    daemon/server/handlers_mesh.c \
    daemon/server/handlers_scene.c \
    daemon/server/handlers_watch.c \
    daemon/server/invariant.c daemon/server/invariant.h \
    daemon/server/laststep.c daemon/server/laststep.h \
    daemon/server/lifeline.c daemon/server/lifeline.h \
    daemon/server/linger.c daemon/server/linger.h \
    daemon/server/listener.c daemon/server/listener.h \
    daemon/server/lockfile.c daemon/server/lockfile.h \
    daemon/server/log.c daemon/server/log.h \
    daemon/server/loop.c daemon/server/loop.h \
    daemon/server/meshes.c daemon/server/meshes.h \
    daemon/server/metrics.c daemon/server/metrics.h \
    daemon/server/now.h \
    daemon/server/options.c daemon/server/options.h \
    daemon/server/overdue.c daemon/server/overdue.h \
    daemon/server/priority.c daemon/server/priority.h \
    daemon/server/quota.c daemon/server/quota.h \
    daemon/server/region.c daemon/server/region.h \
    daemon/server/replies.c daemon/server/replies.h \
    daemon/server/request.c daemon/server/request.h \
    daemon/server/resource.c daemon/server/resource.h \
    daemon/server/ringio.c daemon/server/ringio.h \
    daemon/server/sandbox.c daemon/server/sandbox.h \
    daemon/server/supervise.c daemon/server/supervise.h \
    daemon/server/threads.c daemon/server/threads.h \
    daemon/server/tracing.c daemon/server/tracing.h \
    daemon/server/session.c daemon/server/session.h \
    daemon/server/watch.c daemon/server/watch.h \
    daemon/server/wire.c daemon/server/wire.h
# -iquote and not -I: proto/limits.h must not stand in for the system's <limits.h>.
server_cppflags = $(AM_CPPFLAGS) -iquote $(top_srcdir)/daemon/server \
    $(ENGINE_CPPFLAGS) -iquote $(top_srcdir)/proto
libserver_la_CPPFLAGS = $(server_cppflags)
libserver_la_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) $(SECCOMP_CFLAGS) -pthread
libserver_la_LIBADD = $(SECCOMP_LIBS)

bin_PROGRAMS += pccdd
pccdd_SOURCES = daemon/server/main.c
pccdd_CPPFLAGS = $(server_cppflags)
pccdd_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) -pthread
pccdd_LDADD = libserver.la libengine.la libproto.la $(UV_LIBS)

# The manual page, where scdoc is installed.
EXTRA_DIST += daemon/server/pccdd.8.scd
if HAVE_SCDOC
man8_MANS = daemon/server/pccdd.8
CLEANFILES += daemon/server/pccdd.8
daemon/server/pccdd.8: daemon/server/pccdd.8.scd
	$(AM_V_GEN)$(MKDIR_P) daemon/server && $(SCDOC) <$(top_srcdir)/daemon/server/pccdd.8.scd >$@.tmp && \
	    mv $@.tmp $@
endif
