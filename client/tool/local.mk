# client/tool/local.mk - what pccdctl and pccd-load do in the same way.

noinst_LTLIBRARIES += libtools.la
libtools_la_SOURCES = \
    client/tool/confined.c \
    client/tool/shown.c \
    client/tool/whole_file.c
tool_cppflags = -iquote $(top_srcdir)/client/tool $(text_cppflags)
libtools_la_CPPFLAGS = $(PCCD_CPPFLAGS) $(tool_cppflags)
libtools_la_LIBADD = libtext.la
