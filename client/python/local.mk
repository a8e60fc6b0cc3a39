# client/python/local.mk - the Python module: libpccd by ctypes; nothing is compiled.
#
# python/pccd in the build folder is the whole module: links to the sources, and abi.py, which
# says what pccd.h says. pythondir (configure --with-pythondir) is where Python looks for
# modules below the prefix.

python_module = \
    client/python/module/__init__.py \
    client/python/module/__main__.py \
    client/python/module/answer.py \
    client/python/module/batch.py \
    client/python/module/client.py \
    client/python/module/contacts.py \
    client/python/module/files.py \
    client/python/module/frame.py \
    client/python/module/library.py \
    client/python/module/memory.py \
    client/python/module/mpi.py \
    client/python/module/observe.py \
    client/python/module/parquet.py \
    client/python/module/points.py \
    client/python/module/py.typed \
    client/python/module/rays.py \
    client/python/module/scenes.py \
    client/python/module/turning.py \
    client/python/module/values.py \
    client/python/module/vtk_reader.py \
    client/python/module/weld.py
python_headers = \
    $(top_srcdir)/client/lib/pccd.h \
    $(top_srcdir)/client/lib/pccd_batch.h \
    $(top_srcdir)/client/lib/pccd_near.h \
    $(top_srcdir)/client/lib/pccd_points.h \
    $(top_srcdir)/client/lib/pccd_rays.h \
    $(top_srcdir)/client/lib/pccd_turning.h \
    $(top_srcdir)/client/lib/pccd_weld.h \
    $(top_srcdir)/proto/common/pccd_daemon.h \
    $(top_srcdir)/proto/common/pccd_trace.h \
    $(top_srcdir)/proto/common/pccd_types.h

python_moduledir = $(pythondir)/pccd
dist_python_module_DATA = $(python_module)
nodist_python_module_DATA = python/pccd/abi.py
CLEANFILES += python/pccd/abi.py

python/pccd/abi.py: Makefile $(top_srcdir)/client/python/abi.awk $(python_headers)
	$(AM_V_GEN)$(MKDIR_P) python/pccd && \
	for name in $(python_module); do \
	    rm -f "python/pccd/$${name##*/}" && \
	    $(LN_S) "$(abs_top_srcdir)/$$name" "python/pccd/$${name##*/}" || exit 1; \
	done && \
	{ echo '#include "pccd.h"'; \
	  echo 'pccd_abi_version PCCD_VERSION_MAJOR PCCD_VERSION_MINOR PCCD_VERSION_PATCH'; } | \
	    $(CC) -E -C $(PCCD_CPPFLAGS) -iquote $(top_srcdir)/client/lib - \
	    >python/pccd/abi.i && \
	$(AWK) -v library_folder='$(libdir)' -f $(top_srcdir)/client/python/abi.awk \
	    <python/pccd/abi.i >$@.new && rm python/pccd/abi.i && mv $@.new $@
clean-local: clean-python
clean-python:
	rm -rf python
.PHONY: clean-python

# For people who have no compiler: pip install FILE, also without a network.
wheel: all
	@$(BASH) $(srcdir)/client/python/make_wheel.sh '$(abs_top_srcdir)' '$(abs_top_builddir)' \
	    '$(abs_top_builddir)/dist'
.PHONY: wheel
