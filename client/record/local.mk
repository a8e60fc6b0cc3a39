# client/record/local.mk - the file format of recordings, for those who write and read it.

noinst_LTLIBRARIES += librecord.la

librecord_la_SOURCES = \
    client/record/chunk.c \
    client/record/judge.c \
    client/record/payload.c \
    client/record/reader.c
record_cppflags = -iquote $(top_srcdir)/client/record -iquote $(top_srcdir)/client/lib \
    -iquote $(top_srcdir)/proto
librecord_la_CPPFLAGS = $(PCCD_CPPFLAGS) $(record_cppflags) $(XXHASH_CFLAGS) $(ZSTD_CFLAGS)
librecord_la_LIBADD = $(ZSTD_LIBS)
