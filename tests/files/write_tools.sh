#!/bin/sh
# write_tools.sh - has assimp, gmsh, admesh, OpenSCAD and meshlab write the scenes, those that are here.
#
# Usage:    write_tools.sh SCENES FOLDER
set -u
source=$(cd "$1" && pwd)
mkdir -p "$2"
target=$(cd "$2" && pwd)

# The frames of scenes: their names without .obj, as SCENE or SCENE.0 and SCENE.1.
frames() { # SCENE...
    for scene; do
        for file in "$source/$scene".?.obj; do
            [ -e "$source/$scene.1.obj" ] && basename "$file" .obj || echo "$scene"
        done
    done
}
input() { # FRAME
    case $1 in *.?) echo "$source/$1.obj" ;; *) echo "$source/$1.0.obj" ;; esac
}
named() { # FRAME WAY: SCENE.WAY or SCENE.WAY.N
    case $1 in *.?) echo "${1%.*}.$2.${1##*.}" ;; *) echo "$1.$2" ;; esac
}
here() { # PROGRAM
    command -v "$1" >/dev/null && return
    echo "not written: no $1"
    return 1
}
quiet() {
    timeout 20 "$@" </dev/null >"$target/log" 2>&1 || echo "not written: $*: $(tail -1 "$target/log")"
}
into() { # PROGRAM-VERSION: its folder, and the present one
    mkdir -p "$target/$1" && cd "$target/$1" || exit
}

if here assimp; then
    into "assimp-$(assimp version | sed -n 's/.*Version \([0-9.]*\).*/\1/p')"
    for frame in $(frames cube two cloth drop pass rain through); do
        for form in obj:obj stl:stl stlb:stl ply:ply plyb:ply glb2:glb gltf2:gltf; do
            name=$(named "$frame" "${form%:*}").${form#*:}
            quiet assimp export "$(input "$frame")" "$name" "-f${form%:*}"
        done
    done
    # As polygons; where it cuts them itself, it makes triangles without area.
    for frame in $(frames comb ell slope flag); do
        for form in obj:obj ply:ply plyb:ply; do
            quiet assimp export "$(input "$frame")" "$(named "$frame" "${form%:*}").${form#*:}" \
                "-f${form%:*}"
        done
    done
    for form in fbx:fbx collada:dae x3d:x3d 3ds:3ds; do
        quiet assimp export "$(input cube)" "cube.${form%:*}.${form#*:}" "-f${form%:*}"
    done
fi

if here admesh; then
    into "admesh-$(admesh --version | sed -n '1s/.*version //p')"
    # Without its check it never ends writing OFF and VRML.
    for frame in $(frames cube two drop pass rain); do
        for before in "$target"/assimp-*/"$(named "$frame" stlb)".stl; do
            quiet admesh --no-check --write-ascii-stl="$(named "$frame" ascii).stl" "$before"
            quiet admesh --no-check --write-binary-stl="$(named "$frame" binary).stl" "$before"
            case $frame in *.?) continue ;; esac # its check fills the holes of what is open
            quiet admesh --write-binary-stl="$(named "$frame" checked).stl" "$before"
            quiet admesh --write-off="$(named "$frame" plain).off" "$before"
            quiet admesh --write-vrml="$(named "$frame" plain).wrl" "$before"
        done
    done
fi

if here gmsh; then
    into "gmsh-$(gmsh --version 2>&1)"
    cat >"$target/cube.geo" <<'END'
SetFactory("OpenCASCADE");
Box(1) = {-1, -1, -1, 2, 2, 2};
Transfinite Curve {:} = 2;
Transfinite Surface {:};
Mesh.Algorithm = 1;
END
    for form in stl:stl ply2:ply2 msh22:msh msh41:msh vtk:vtk off:off wrl:wrl; do
        quiet gmsh -2 -format "${form%:*}" -o "cube.${form%:*}.${form#*:}" "$target/cube.geo"
        quiet gmsh -2 -bin -format "${form%:*}" -o "cube.${form%:*}-bin.${form#*:}" "$target/cube.geo"
    done
    for frame in $(frames cloth drop pass rain); do
        for before in "$target"/assimp-*/"$(named "$frame" stlb)".stl; do
            for form in stl:stl msh22:msh msh41:msh vtk:vtk; do
                quiet gmsh -save -format "${form%:*}" -o "$(named "$frame" "${form%:*}").${form#*:}" \
                    "$before"
            done
            quiet gmsh -save -bin -format stl -o "$(named "$frame" stl-bin).stl" "$before"
        done
    done
fi

if here openscad; then
    into "openscad-$(openscad --version 2>&1 | sed 's/.*version //')"
    echo 'cube(2, center = true);' >"$target/cube.scad"
    echo 'cube(2, center = true); translate([3, 0, 0]) cube(2, center = true);' >"$target/two.scad"
    for scene in cube two; do
        for form in asciistl:stl binstl:stl off:off amf:amf 3mf:3mf; do
            quiet openscad --export-format "${form%:*}" -o "$scene.${form%:*}.${form#*:}" \
                "$target/$scene.scad"
        done
    done
fi

if here meshlabserver && here xvfb-run; then
    into "meshlab-$(dpkg-query -W -f '${Version}' meshlab | sed 's/+.*//')"
    for frame in $(frames cube two cloth drop pass rain); do
        for before in "$target"/assimp-*/"$(named "$frame" stlb)".stl; do
            set -- -i "$before" # its reader of OBJ is stopped by an assertion of its own
            for ending in obj ply stl off dae x3d wrl; do
                set -- "$@" -o "$(named "$frame" plain).$ending"
            done
            quiet xvfb-run -a meshlabserver "$@"
        done
    done
fi
rm -f "$target/log" "$target"/cube.* "$target"/two.*
