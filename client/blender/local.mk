# client/blender/local.mk - the add-on for Blender: Python only; nothing is compiled.

# For "Install from disk": with the Python module and all libraries inside.
blender-addon: all
	@$(BASH) $(srcdir)/client/blender/make_addon.sh '$(abs_top_srcdir)' '$(abs_top_builddir)' \
	    '$(abs_top_builddir)/pccd_blender.zip'
.PHONY: blender-addon
CLEANFILES += pccd_blender.zip
