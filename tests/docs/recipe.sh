# recipe.sh - runs a recipe of the site as it is written. For scripts that source it.
#
# Needs: top_srcdir, top_builddir; python, the one that find.sh has found, and its PYTHONPATH.

# A program of a recipe stands between fences and begins with its name, commands stand behind
# four blanks.
unpack() { # FILE FOLDER
    awk -v folder="$2" '
        /^```/ { fence = !fence; name = ""; empty = 0; block = 0; next }
        fence && name == "" { split($0, word, " "); name = folder "/" word[2] }
        fence { print > name; next }
        /^    [^ ]/ && (empty || block) { print substr($0, 5) > (folder "/commands"); block = 1; next }
        { empty = $0 == ""; block = 0 }' "$1"
}

# pictures RECIPE: the pictures of a recipe that its own commands make.
pictures() { sed -nE 's/.*\]\(([a-z_]+\.a?png)\).*/\1/p' "$top_srcdir/client/man/site/$1.md"; }

# run_recipe RECIPE FOLDER: its output; fails if a command does, or a picture is not made.
run_recipe() {
    local picture
    mkdir -p "$2/run" "$2/bin" && unpack "$top_srcdir/client/man/site/$1.md" "$2" || return
    ln -sf "$(command -v "$python")" "$2/bin/python3"
    sed -i -E '/^(\.\/bootstrap|make|export) /d' "$2/commands" # of an installation
    # A check that finds what its recipe says ends with 1.
    sed -i -E '/^pccdctl check /s/ *(#.*)?$/ || [ $? -eq 1 ]/' "$2/commands"
    if [ ! -s "$top_builddir/client/inspect/page.html" ]; then
        sed -i '/^pccdctl inspect /d' "$2/commands"
    fi
    (cd "$2" && XDG_RUNTIME_DIR=$PWD/run PATH=$PWD/bin:$top_builddir:$PATH \
        timeout 120 bash -ex commands) 2>&1 </dev/null && [ "$(wc -l <"$2/commands")" -ge 2 ] || return
    for picture in $(pictures "$1"); do
        [ -s "$2/$picture" ] || { echo "no $picture"; return 1; }
    done
}
