# client/lib/local.mk - libpccd, the client library.
#
# All of it is libclient.la: libpccd.la is that and nothing else, and our own programs have it
# within. They are then the programs themselves in the build folder, too, not scripts that start
# them, and need no path to a library wherever they are installed.

lib_LTLIBRARIES += libpccd.la
noinst_LTLIBRARIES += libclient.la
include_HEADERS += client/lib/pccd.h client/lib/pccd_batch.h client/lib/pccd_near.h \
    client/lib/pccd_points.h client/lib/pccd_rays.h client/lib/pccd_turning.h \
    client/lib/pccd_weld.h
pkgconfig_DATA += client/lib/pccd.pc

libclient_la_SOURCES = \
    client/lib/answer.c \
    client/lib/attach.c \
    client/lib/batch.c \
    client/lib/client.c \
    client/lib/connect.c \
    client/lib/connection.c \
    client/lib/direct.c \
    client/lib/events.c \
    client/lib/frame.c \
    client/lib/launch.c \
    client/lib/link.c \
    client/lib/list.c \
    client/lib/manifold.c \
    client/lib/mesh.c \
    client/lib/page.c \
    client/lib/points.c \
    client/lib/rays.c \
    client/lib/receive.c \
    client/lib/record.c \
    client/lib/recorder.c \
    client/lib/recorder_events.c \
    client/lib/recorder_requests.c \
    client/lib/recorder_shared.c \
    client/lib/recorder_snapshot.c \
    client/lib/recover.c \
    client/lib/replica.c \
    client/lib/restore.c \
    client/lib/ring.c \
    client/lib/rpc.c \
    client/lib/safe.c \
    client/lib/scene.c \
    client/lib/stats.c \
    client/lib/step.c \
    client/lib/turning.c \
    client/lib/user_data.c \
    client/lib/weld.c
libclient_la_CPPFLAGS = $(PCCD_CPPFLAGS) -iquote $(top_srcdir)/proto \
    -iquote $(top_srcdir)/client/lib -iquote $(top_srcdir)/client/record \
    -iquote $(top_srcdir)/client/registry \
    -DCLI_DAEMON_PATH='"$(bindir)/pccdd"' -DCLI_LIBRARY_FOLDER='"$(libdir)"'
libclient_la_LIBADD = libregistry.la librecord.la libproto.la

libpccd_la_SOURCES =
libpccd_la_LIBADD = libclient.la $(LIBM)
libpccd_la_LDFLAGS = $(AM_LDFLAGS) -no-undefined -version-info 0:0:0 \
    -Wl,--version-script=$(top_srcdir)/client/lib/libpccd.map
EXTRA_libpccd_la_DEPENDENCIES = client/lib/libpccd.map
