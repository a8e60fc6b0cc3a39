# proto/local.mk - the wire: messages, codec, datagrams, shared memory.

noinst_LTLIBRARIES += libproto.la

libproto_la_SOURCES = \
    proto/codec.c \
    proto/encode.c \
    proto/memfd.c \
    proto/messages.c \
    proto/prescan.c \
    proto/seqpacket.c
libproto_la_CPPFLAGS = $(PCCD_CPPFLAGS) -iquote $(top_srcdir)/proto $(MSGPACK_CFLAGS)
libproto_la_LIBADD = $(MSGPACK_LIBS)

dist_doc_DATA += proto/PROTOCOL.md

# The tables of PROTOCOL.md and pccd-protocol.7, and the list of fields in tests/abi, from the
# manifest: make protocol-doc writes them anew.
noinst_PROGRAMS += proto/gendoc
proto_gendoc_CPPFLAGS = $(PCCD_CPPFLAGS) -iquote $(top_srcdir)/proto
proto_gendoc_LDADD = libproto.la

protocol-doc: proto/gendoc$(EXEEXT)
	$(AM_V_GEN)proto/gendoc$(EXEEXT) <$(srcdir)/proto/PROTOCOL.md >PROTOCOL.new && \
	    cat PROTOCOL.new >$(srcdir)/proto/PROTOCOL.md && \
	    proto/gendoc$(EXEEXT) manual <$(srcdir)/client/man/pccd-protocol.7.scd >PROTOCOL.new && \
	    cat PROTOCOL.new >$(srcdir)/client/man/pccd-protocol.7.scd && \
	    proto/gendoc$(EXEEXT) manifest >PROTOCOL.new && \
	    if grep -vxFf PROTOCOL.new $(srcdir)/tests/abi/manifest.txt; then \
	        echo "these lines of tests/abi/manifest.txt are gone or changed:" \
	            "what was published stays; take them out by hand if it was not" >&2; \
	        rm PROTOCOL.new; exit 1; \
	    fi && cat PROTOCOL.new >$(srcdir)/tests/abi/manifest.txt && rm PROTOCOL.new
.PHONY: protocol-doc
