# tests/files/local.mk - files of real programs; each is skipped by name where it is not here.

test_scripts += tests/files/test_files_programs.sh

# A row for each file in $PCCD_FILES, or of the programs that are here, and the sums.
files-table: all
	files="$${PCCD_FILES:-files}"; \
	test -d "$$files" || $(srcdir)/tests/files/make_files.sh "$$files"; \
	PCCDCTL=$(abs_builddir)/pccdctl PCCD_DAEMON=$(abs_builddir)/pccdd \
	    PYTHONPATH=$(abs_builddir)/python \
	    python3 $(srcdir)/tests/files/judge_files.py --table "$$files/scenes/scenes.json" \
	    $$(ls -d "$$files"/*-[0-9]*)
.PHONY: files-table

check_PROGRAMS += tests/files/read_mesh
tests_files_read_mesh_CPPFLAGS = $(PCCD_CPPFLAGS) $(ctl_cppflags)
tests_files_read_mesh_LDADD = libctl.la $(JANSSON_LIBS) $(LIBM)

# Times and memory of the readers, beside meshio, trimesh and $OLD_READ_MESH, that program of
# another build.
read-table: tests/files/read_mesh
	folder=$$(mktemp -d) && trap 'rm -r "$$folder"' EXIT && \
	python3 $(srcdir)/tests/files/read_table.py "$$folder" $(abs_builddir)/tests/files/read_mesh \
	    $$OLD_READ_MESH
.PHONY: read-table
