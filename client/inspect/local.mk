# client/inspect/local.mk - the page of `pccdctl inspect`, bundled into one file.

PAGE_FILES = \
    client/inspect/build.mjs \
    client/inspect/fetch_modules.sh \
    client/inspect/make_page.sh \
    client/inspect/package.json \
    client/inspect/package-lock.json \
    client/inspect/src/address.js \
    client/inspect/src/boxes.js \
    client/inspect/src/colours.js \
    client/inspect/src/contacts.js \
    client/inspect/src/counters.js \
    client/inspect/src/data.js \
    client/inspect/src/dom.js \
    client/inspect/src/find.js \
    client/inspect/src/index.html \
    client/inspect/src/joints.js \
    client/inspect/src/keys.js \
    client/inspect/src/lanes.js \
    client/inspect/src/main.js \
    client/inspect/src/marks.js \
    client/inspect/src/objects.js \
    client/inspect/src/panels.js \
    client/inspect/src/scene.js \
    client/inspect/src/shaders.js \
    client/inspect/src/solids.js \
    client/inspect/src/state.js \
    client/inspect/src/style.css \
    client/inspect/src/timeline.js \
    client/inspect/src/transport.js \
    client/inspect/src/words.js

client/inspect/page.html: $(PAGE_FILES) Makefile
	$(AM_V_GEN)$(SHELL) $(srcdir)/client/inspect/make_page.sh '$(with_inspect)' '$(srcdir)' $@
CLEANFILES += client/inspect/page.html client/inspect/page.html.tmp

# The tarball has the page as well as its sources: whoever builds it needs neither node nor
# npm.
dist-hook: client/inspect/page.html
	if test -s client/inspect/page.html; then \
	    cp client/inspect/page.html $(distdir)/client/inspect/page.dist.html; \
	else \
	    echo 'this tarball has no page of pccdctl inspect; ./bootstrap fetches it' >&2; \
	fi
distclean-local:
	rm -rf client/inspect/npm
