# client/man/local.mk - the manual pages, from scdoc.
#
# The tarball has the pages as well as their sources: whoever builds it needs no scdoc. They
# bear the date of the tarball, not of the day.

MAN_SOURCES = \
    client/man/libpccd.3.scd \
    client/man/pccd-load.1.scd \
    client/man/pccd-protocol.7.scd \
    client/man/pccd.7.scd \
    client/man/pccdctl.1.scd \
    client/man/pccdd.8.scd

# Of what is built with an MPI alone.
MPI_MAN_SOURCES = \
    client/man/libpccd-mpi.3.scd \
    client/man/pccd-mpi.1.scd

if HAVE_MAN_PAGES
dist_man_MANS += $(MAN_SOURCES:.scd=)
if HAVE_MPI
dist_man_MANS += $(MPI_MAN_SOURCES:.scd=)
else
EXTRA_DIST += $(MPI_MAN_SOURCES:.scd=)
endif
MAINTAINERCLEANFILES = $(MAN_SOURCES:.scd=) $(MPI_MAN_SOURCES:.scd=)
endif

SUFFIXES = .scd
.scd:
	$(AM_V_GEN)$(MKDIR_P) $(@D) && test -n '$(SCDOC)' && \
	    SOURCE_DATE_EPOCH="$(dist_epoch)" $(SCDOC) <$< >$@.tmp && mv $@.tmp $@

# The synopsis of pccdctl's page, anew from its tables of options.
synopsis-doc: pccdctl$(EXEEXT)
	$(AM_V_GEN)page=$(srcdir)/client/man/pccdctl.1.scd; \
	    { sed '/^# SYNOPSIS/q' "$$page" && echo && ./pccdctl$(EXEEXT) completion synopsis && \
	    echo && sed -n '/^# DESCRIPTION/,$$p' "$$page"; } >synopsis.new && \
	    cat synopsis.new >"$$page" && rm synopsis.new
.PHONY: synopsis-doc

# The documents as pages for a browser, in build/site; open index.html. It needs mandoc and the
# Python module markdown (python3-markdown), and nothing of the network; what else it takes where
# it is installed, make_site.py says.
site: $(dist_man_MANS)
	@for python in '$(PYTHON3)' /usr/bin/python3; do \
	    "$$python" -c 'import markdown' 2>/dev/null || continue; \
	    command -v mandoc >/dev/null || break; \
	    rm -rf site; \
	    exec "$$python" $(srcdir)/client/man/site/make_site.py '$(abs_top_srcdir)' \
	        '$(abs_top_builddir)' '$(abs_top_builddir)/site'; \
	done; echo 'make site needs mandoc and python3-markdown' >&2; exit 1
.PHONY: site

# The pictures of the recipes, anew, after a change of what pccdctl draws.
site-pictures: all
	$(AM_V_GEN)$(AM_TESTS_ENVIRONMENT) $(BASH) $(top_srcdir)/tests/docs/site_pictures.sh
.PHONY: site-pictures
clean-local: clean-site
clean-site:
	rm -rf site
.PHONY: clean-site
