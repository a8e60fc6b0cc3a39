# proto/local.mk - the wire: messages, codec, datagrams, shared memory.

noinst_LTLIBRARIES += libproto.la

libproto_la_SOURCES = \
    proto/codec.h \
    proto/limits.h \
    proto/memfd.h \
    proto/messages.def \
    proto/messages.h \
    proto/pccd_types.h \
    proto/records.h \
    proto/seqpacket.h \
    proto/shm.h \
    proto/utf8.h \
    proto/codec.c \
    proto/encode.c \
    proto/memfd.c \
    proto/messages.c \
    proto/prescan.c \
    proto/seqpacket.c
libproto_la_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/proto $(MSGPACK_CFLAGS)
libproto_la_LIBADD = $(MSGPACK_LIBS)

include_HEADERS += proto/pccd_types.h
