# client/blender/local.mk - the add-on for Blender: Python only; nothing is compiled.

blender_addon = \
    client/blender/addon/__init__.py \
    client/blender/addon/check.py \
    client/blender/addon/command.py \
    client/blender/addon/extract.py \
    client/blender/addon/library.py \
    client/blender/addon/markers.py \
    client/blender/addon/octahedra.py \
    client/blender/addon/panel.py \
    client/blender/addon/report.py \
    client/blender/addon/shape.py
EXTRA_DIST += $(blender_addon) client/blender/README.md client/blender/make_addon.sh \
    client/blender/marked.png

# For "Install from disk": with the Python module and all libraries inside.
blender-addon: all
	@$(BASH) $(srcdir)/client/blender/make_addon.sh '$(abs_top_srcdir)' '$(abs_top_builddir)' \
	    '$(abs_top_builddir)/pccd_blender.zip'
.PHONY: blender-addon
CLEANFILES += pccd_blender.zip
