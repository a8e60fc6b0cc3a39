# daemon/server/local.mk - program pccdd, from a library that the unit tests link too.

noinst_LTLIBRARIES += libserver.la
libserver_la_SOURCES = \
    daemon/server/activate.c \
    daemon/server/allow.c \
    daemon/server/wakeup.c \
    daemon/server/closer.c \
    daemon/server/commandline.c \
    daemon/server/conn.c \
    daemon/server/crash.c \
    daemon/server/landlock.c \
    daemon/server/kept.c \
    daemon/server/lifeline.c \
    daemon/server/listener.c \
    daemon/server/lockfile.c \
    daemon/server/notify.c \
    daemon/server/outlet.c \
    daemon/server/heartbeat.c \
    daemon/server/reactor.c \
    daemon/server/server.c \
    daemon/server/replyqueue.c \
    daemon/server/sandbox.c \
    daemon/server/socketfile.c \
    daemon/server/supervise.c \
    daemon/server/threads.c \
    daemon/server/timer.c \
    daemon/server/watch.c
server_cppflags = $(service_cppflags) -iquote $(top_srcdir)/daemon/server
libserver_la_CPPFLAGS = $(server_cppflags)
libserver_la_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) $(SECCOMP_CFLAGS) -pthread
libserver_la_LIBADD = libservice.la $(SECCOMP_LIBS)

bin_PROGRAMS += pccdd
pccdd_SOURCES = daemon/server/main.c
pccdd_CPPFLAGS = $(server_cppflags)
pccdd_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) -pthread
pccdd_LDADD = libserver.la libengine.la libproto.la $(UV_LIBS)
