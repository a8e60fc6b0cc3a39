# unpack.sh - what the scripts of this folder share; each sources it and begins with `unpack`.
#
# A finding installs public Debian packages of a pinned version in a temporary folder, shows one
# behaviour of theirs on valid input, without pccd, and exits with
#
#   0  it behaves as the head of the script says
#   1  it behaves otherwise now: what that head says has to be looked at again
#   2  it could not be tried: no such package of that version here, no compiler

set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
trap 'exit 2' HUP INT TERM

# Unpack each PACKAGE=VERSION into $folder/root, and say what was taken.
unpack() {
    mkdir -p "$folder/root" "$folder/deb"
    for package; do
        (cd "$folder/deb" && apt-get download -q -o APT::Sandbox::User=root "$package") >/dev/null 2>&1 ||
            { echo "$0: there is no $package to download here" >&2; exit 2; }
        echo "package: $package"
    done
    for deb in "$folder"/deb/*.deb; do
        dpkg-deb -x "$deb" "$folder/root"
    done
}

# Compare what was seen, $1, with what is expected, $2.
expect() {
    printf 'seen:\n%s\n' "$1"
    [ "$1" = "$2" ] && return
    printf 'expected:\n%s\n' "$2"
    exit 1
}
