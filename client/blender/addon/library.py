"""library.py - the Python module pccd that the add-on calls.

Room:     client/blender. Needs no Blender.
Does:     take the one that the add-on's zip brought, or else the one that is installed,
          as in Debian's package.
"""

import importlib.util

if importlib.util.find_spec(__package__ + ".pccd") is not None:
    from . import pccd
else:
    try:
        import pccd
    except ModuleNotFoundError:
        raise ImportError("no Python module pccd: install the add-on from the zip that "
                          "brings it, or Debian's package python3-pccd") from None

__all__ = ["pccd"]
