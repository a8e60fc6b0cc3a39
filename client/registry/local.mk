# client/registry/local.mk - what a client has told a daemon, for those who tell it another.

noinst_LTLIBRARIES += libregistry.la

libregistry_la_SOURCES = \
    client/registry/registry.c \
    client/registry/registry_map.c \
    client/registry/registry_pairs.c \
    client/registry/registry_positions.c
registry_cppflags = -iquote $(top_srcdir)/client/registry
libregistry_la_CPPFLAGS = $(PCCD_CPPFLAGS) $(registry_cppflags)
