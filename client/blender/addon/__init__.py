"""__init__.py - pccd for Blender: where objects cross at a frame, or meet between two.

Room:     client/blender; installed as Blender's add-on "pccd_blender".
Does:     register the panel; bake_check() checks a file without a window.
Threads:  Blender's own.
"""

bl_info = {
    "name": "pccd: crossings and contacts",
    "author": "pccd authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > pccd",
    "description": "Find every place where objects cross at a frame, or meet between two",
    "category": "Physics",
    "support": "COMMUNITY",
}


def register():
    from . import panel
    panel.register()


def unregister():
    from . import panel
    panel.unregister()


def bake_check():
    """Check the file that Blender has open, by the arguments after "--", and end Blender
    with an exit status; command.py says which.

        blender -b FILE --python-exit-code 4 \\
            --python-expr "import pccd_blender; pccd_blender.bake_check()" -- \\
            --frames 1:100 --thickness 0.001 --json
    """
    from . import command
    command.main()
