"""library.py - the Python module pccd that the add-on calls.

Room:     client/blender. Needs no Blender.
Does:     take the one that the add-on's zip brought, or else the one that is installed,
          as in Debian's package.
"""

import importlib.util

if importlib.util.find_spec(__package__ + ".pccd") is not None:
    from . import pccd
else:
    import pccd

__all__ = ["pccd"]
