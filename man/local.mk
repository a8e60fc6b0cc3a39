# man/local.mk - the manual pages, from scdoc.
#
# The tarball has the pages as well as their sources: whoever builds it needs no scdoc. They
# bear the date of the tarball, not of the day.

MAN_SOURCES = \
    man/libpccd.3.scd \
    man/pccd-load.1.scd \
    man/pccd-protocol.7.scd \
    man/pccd.7.scd \
    man/pccdctl.1.scd \
    man/pccdd.8.scd
EXTRA_DIST += $(MAN_SOURCES)

if HAVE_MAN_PAGES
dist_man_MANS += $(MAN_SOURCES:.scd=)
MAINTAINERCLEANFILES = $(dist_man_MANS)
endif

SUFFIXES = .scd
.scd:
	$(AM_V_GEN)$(MKDIR_P) $(@D) && test -n '$(SCDOC)' && \
	    SOURCE_DATE_EPOCH="$(dist_epoch)" $(SCDOC) <$< >$@.tmp && mv $@.tmp $@
