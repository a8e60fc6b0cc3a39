# client/lib/local.mk - libpccd, the client library.
#
# All of it is libclient.la: libpccd.la is that and nothing else, and our own programs have it
# within. They are then the programs themselves in the build folder, too, not scripts that start
# them, and need no path to a library wherever they are installed.

lib_LTLIBRARIES += libpccd.la
noinst_LTLIBRARIES += libclient.la
include_HEADERS += client/lib/pccd.h client/lib/pccd_batch.h client/lib/pccd_near.h \
    client/lib/pccd_weld.h
pkgconfig_DATA += client/lib/pccd.pc

libclient_la_SOURCES = \
    client/lib/attach.c \
    client/lib/attach.h \
    client/lib/batch.c \
    client/lib/batch.h \
    client/lib/boxes.c \
    client/lib/call.h \
    client/lib/client.c \
    client/lib/client.h \
    client/lib/connect.c \
    client/lib/connection.c \
    client/lib/connection.h \
    client/lib/direct.c \
    client/lib/direct.h \
    client/lib/foreign.h \
    client/lib/filter.c \
    client/lib/flight.c \
    client/lib/flight.h \
    client/lib/frame.c \
    client/lib/frame.h \
    client/lib/keep.c \
    client/lib/keep.h \
    client/lib/launch.c \
    client/lib/launch.h \
    client/lib/link.c \
    client/lib/link.h \
    client/lib/list.c \
    client/lib/mesh.c \
    client/lib/mesh.h \
    client/lib/near.c \
    client/lib/page.c \
    client/lib/page.h \
    client/lib/positions.c \
    client/lib/positions.h \
    client/lib/receive.c \
    client/lib/receive.h \
    client/lib/record.c \
    client/lib/record.h \
    client/lib/recorder.c \
    client/lib/recorder.h \
    client/lib/recorder_events.c \
    client/lib/recorder_events.h \
    client/lib/recorder_shared.c \
    client/lib/recorder_shared.h \
    client/lib/recorder_snapshot.c \
    client/lib/recover.c \
    client/lib/recover.h \
    client/lib/restore.c \
    client/lib/restore.h \
    client/lib/ring.c \
    client/lib/ring.h \
    client/lib/rpc.c \
    client/lib/rpc.h \
    client/lib/scene.c \
    client/lib/shared.c \
    client/lib/shared.h \
    client/lib/stats.c \
    client/lib/safe.c \
    client/lib/step.c \
    client/lib/step.h \
    client/lib/struct_size.c \
    client/lib/struct_size.h \
    client/lib/submit.c \
    client/lib/submit.h \
    client/lib/trace.c \
    client/lib/watch.c \
    client/lib/watch.h \
    client/lib/weld.c
libclient_la_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/proto \
    -iquote $(top_srcdir)/client/lib -iquote $(top_srcdir)/client/record \
    -iquote $(top_srcdir)/client/registry \
    -DCLI_DAEMON_PATH='"$(bindir)/pccdd"' -DCLI_LIBRARY_FOLDER='"$(libdir)"'
libclient_la_LIBADD = libregistry.la librecord.la libproto.la

libpccd_la_SOURCES =
libpccd_la_LIBADD = libclient.la
libpccd_la_LDFLAGS = $(AM_LDFLAGS) -no-undefined -version-info 0:0:0 \
    -Wl,--version-script=$(top_srcdir)/client/lib/libpccd.map
EXTRA_libpccd_la_DEPENDENCIES = client/lib/libpccd.map
EXTRA_DIST += client/lib/libpccd.map
