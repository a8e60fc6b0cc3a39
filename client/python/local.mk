# client/python/local.mk - the Python client; nothing is built.
#
# pythondir (configure --with-pythondir) is where Python looks for modules below the prefix.

python_partsdir = $(pythondir)/_pccd
dist_python_DATA = client/python/pccd.py
dist_python_parts_DATA = \
    client/python/_pccd/__init__.py \
    client/python/_pccd/answer.py \
    client/python/_pccd/frame.py \
    client/python/_pccd/keep.py \
    client/python/_pccd/launch.py \
    client/python/_pccd/link.py \
    client/python/_pccd/observe.py \
    client/python/_pccd/reach.py \
    client/python/_pccd/recover.py \
    client/python/_pccd/restore.py \
    client/python/_pccd/ring.py \
    client/python/_pccd/scenes.py \
    client/python/_pccd/upload.py \
    client/python/_pccd/values.py \
    client/python/_pccd/wire.py
EXTRA_DIST += client/python/example_cloth.py client/python/example_shared.py
