# proto/text/local.mk - text for people, as daemon and programs write it.

noinst_LTLIBRARIES += libtext.la
libtext_la_SOURCES = \
    proto/text/option_table.c proto/text/printable.c
text_cppflags = -iquote $(top_srcdir)/proto/text
libtext_la_CPPFLAGS = $(PCCD_CPPFLAGS) $(text_cppflags) -iquote $(top_srcdir)/proto
