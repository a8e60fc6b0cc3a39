# daemon/direct/local.mk - libpccd-direct: the service in the process of its client. libpccd
# loads it for the url direct: and no program links with it.

lib_LTLIBRARIES += libpccd-direct.la
libpccd_direct_la_SOURCES = \
    daemon/direct/direct.c \
    daemon/direct/inbox.c \
    daemon/direct/timers.c
libpccd_direct_la_CPPFLAGS = $(service_cppflags) -iquote $(top_srcdir)/daemon/direct
libpccd_direct_la_CFLAGS = $(AM_CFLAGS) -pthread
libpccd_direct_la_LIBADD = libservice.la libengine.la libproto.la
libpccd_direct_la_LDFLAGS = $(AM_LDFLAGS) -no-undefined $(PCCD_DEFS) -version-info 0:0:0 \
    -Wl,--version-script=$(top_srcdir)/daemon/direct/libpccd-direct.map
EXTRA_libpccd_direct_la_DEPENDENCIES = daemon/direct/libpccd-direct.map
