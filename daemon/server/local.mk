# daemon/server/local.mk - program pccdd, from a library that the unit tests link too.

noinst_LTLIBRARIES += libserver.la
libserver_la_SOURCES = \
    daemon/server/activate.c daemon/server/activate.h \
    daemon/server/allow.c daemon/server/allow.h \
    daemon/server/wakeup.c daemon/server/wakeup.h \
    daemon/server/closer.c daemon/server/closer.h \
    daemon/server/commandline.c daemon/server/commandline.h \
    daemon/server/conn.c daemon/server/conn.h \
    daemon/server/crash.c daemon/server/crash.h \
    daemon/server/landlock.c daemon/server/landlock.h \
    daemon/server/kept.c daemon/server/kept.h \
    daemon/server/lifeline.c daemon/server/lifeline.h \
    daemon/server/listener.c daemon/server/listener.h \
    daemon/server/lockfile.c daemon/server/lockfile.h \
    daemon/server/notify.c daemon/server/notify.h \
    daemon/server/outbox.c daemon/server/outbox.h \
    daemon/server/outlet.c daemon/server/outlet.h \
    daemon/server/priority.c daemon/server/priority.h \
    daemon/server/heartbeat.c daemon/server/heartbeat.h \
    daemon/server/deferred.c daemon/server/deferred.h \
    daemon/server/reactor.c daemon/server/reactor.h \
    daemon/server/refused.c daemon/server/refused.h \
    daemon/server/replyqueue.c daemon/server/replyqueue.h \
    daemon/server/sandbox.c daemon/server/sandbox.h daemon/server/sandbox_calls.h \
    daemon/server/server.h \
    daemon/server/socketfile.c daemon/server/socketfile.h \
    daemon/server/supervise.c daemon/server/supervise.h \
    daemon/server/threads.c daemon/server/threads.h \
    daemon/server/timer.c \
    daemon/server/watch.c daemon/server/watch.h
server_cppflags = $(service_cppflags) -iquote $(top_srcdir)/daemon/server
libserver_la_CPPFLAGS = $(server_cppflags)
libserver_la_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) $(SECCOMP_CFLAGS) -pthread
libserver_la_LIBADD = libservice.la $(SECCOMP_LIBS)

bin_PROGRAMS += pccdd
pccdd_SOURCES = daemon/server/main.c
pccdd_CPPFLAGS = $(server_cppflags)
pccdd_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) -pthread
pccdd_LDADD = libserver.la libengine.la libproto.la $(UV_LIBS)
