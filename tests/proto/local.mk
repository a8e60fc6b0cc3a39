# tests/proto/local.mk - the codec, the transport and the sealed memory.

proto_tests = \
    test_proto_codec \
    test_proto_damage \
    test_proto_malformed \
    test_proto_memfd \
    test_proto_seqpacket
check_PROGRAMS += $(proto_tests)
TESTS += $(proto_tests)

proto_test_cppflags = $(AM_CPPFLAGS) -iquote $(top_srcdir)/proto \
    -iquote $(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
proto_test_libs = libproto.la $(CMOCKA_LIBS) $(LIBM)

test_proto_codec_SOURCES = tests/proto/test_proto_codec.c
test_proto_codec_CPPFLAGS = $(proto_test_cppflags)
test_proto_codec_LDADD = $(proto_test_libs)

test_proto_damage_SOURCES = tests/proto/test_proto_damage.c
test_proto_damage_CPPFLAGS = $(proto_test_cppflags)
test_proto_damage_LDADD = $(proto_test_libs)

test_proto_malformed_SOURCES = tests/proto/test_proto_malformed.c
test_proto_malformed_CPPFLAGS = $(proto_test_cppflags)
test_proto_malformed_LDADD = $(proto_test_libs)

test_proto_memfd_SOURCES = tests/proto/test_proto_memfd.c
test_proto_memfd_CPPFLAGS = $(proto_test_cppflags)
test_proto_memfd_LDADD = $(proto_test_libs)

test_proto_seqpacket_SOURCES = tests/proto/test_proto_seqpacket.c
test_proto_seqpacket_CPPFLAGS = $(proto_test_cppflags)
test_proto_seqpacket_LDADD = $(proto_test_libs)

# Generated tables, and the messages as they were frozen.
TESTS += tests/proto/test_proto_document.sh
