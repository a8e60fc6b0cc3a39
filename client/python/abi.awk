# abi.awk - pccd.h for Python's ctypes: enums, structs and functions as the compiler sees them.
#
# Reads what `cc -E -C` makes of the public headers, and writes the module pccd/abi.py. Knows as
# much of C as these headers use: enums, structs of plain members, arrays, pointers and
# functions, typedefs of functions, prototypes. tests/python compares sizes, offsets and values
# with the compiler's.
#
#   cc -E -C -iquote ... - | awk -v library_folder=/usr/lib -f abi.awk >abi.py

function fail(what) {
    print "abi.awk: not understood: " what >"/dev/stderr"
    failed = 1
    exit 1
}

function trim(text) {
    gsub(/^[ \t\n]+|[ \t\n]+$/, "", text)
    return text
}

# Python's names of numbers, and of what a "*" stands behind.
function type_of(text, is_result,    base) {
    base = text
    gsub(/(^| )const( |$)/, " ", base)
    gsub(/ +/, " ", base)
    base = trim(base)
    if (base ~ /^char ?\*$/)
        return "ctypes.c_char_p"
    if (base ~ /\*/)
        return "ctypes.c_void_p"
    if (base ~ /^enum /)
        return "ctypes.c_int"
    if (base ~ /^struct /)
        return substr(base, 8)
    if (base == "char")
        return "ctypes.c_char"
    if (base == "void")
        return "None"
    if (base == "_Bool" || base == "bool")
        return "ctypes.c_bool"
    if (base ~ /^u?int(8|16|32|64)_t$/) {
        sub(/_t$/, "", base)
        return "ctypes.c_" base
    }
    if (base ~ /^(int|float|double|size_t)$/)
        return "ctypes.c_" base
    if (base in callbacks)
        return base
    fail("type \"" text "\"")
}

# The types of parameters, ", T" each. In a callback structs are pointed to, elsewhere addresses
# are addresses.
function parameters(text, in_callback,    list, i, n, one, made) {
    n = split(text, list, ",")
    for (i = 1; i <= n; i++) {
        one = trim(list[i])
        if (one == "void")
            continue
        if (one ~ /[][(]/) # an array, or a pointer to one
            made = made ", ctypes.c_void_p"
        else if (in_callback && one ~ /struct [a-z_]+ \*/) {
            sub(/.*struct /, "", one)
            sub(/ .*/, "", one)
            made = made ", ctypes.POINTER(" one ")"
        } else {
            sub(/[a-z0-9_]+$/, "", one)
            made = made ", " type_of(one)
        }
    }
    return made
}

# A number in brackets: written so, or one of the enumerators'.
function dimension(text) {
    text = trim(text)
    return text in value_of ? value_of[text] : text
}

function print_doc(text) {
    gsub(/^\/\*+|\*+\/$/, "", text)
    gsub(/\n[ \t]*\*/, " ", text)
    gsub(/[ \t\n]+/, " ", text)
    text = trim(text)
    if (text == "" || text ~ /^----|Room:/) # a line across, or the head of a file
        return
    gsub(/\\/, "\\\\", text)
    sub(/"$/, "\" ", text)
    print "    \"\"\"" text "\"\"\"\n"
}

function print_enum(name, body, doc,    list, i, n, word, words, class, prefixes, key, at, value,
                    kind) {
    n = split(name, words, "_")
    for (i = 2; i <= n; i++) # pccd_object_what: ObjectWhat, PCCD_OBJECT_WHAT_, PCCD_OBJECT_, PCCD_
        class = class toupper(substr(words[i], 1, 1)) substr(words[i], 2)
    kind = words[n] == "flag" || name == "pccd_object_what" ? "IntFlag" : "IntEnum"
    print "\n\nclass " class "(enum." kind "):"
    print_doc(doc)
    n = split(body, list, ",")
    value = -1
    for (i = 1; i <= n; i++) {
        word = trim(list[i])
        if (word == "")
            continue
        at = index(word, "=")
        key = trim(at ? substr(word, 1, at - 1) : word)
        value = at ? trim(substr(word, at + 1)) : value " + 1"
        while (match(value, /[0-9a-fA-F][uUlL]+/)) # Python's numbers have no suffix
            value = substr(value, 1, RSTART) substr(value, RSTART + RLENGTH)
        if (value ~ /^\(.*\)$/)
            value = substr(value, 2, length(value) - 2)
        value_of[key] = value
        if (key ~ /_COUNT$/)
            continue
        print "    " short_name(key, words) " = " value
    }
}

# PCCD_HISTOGRAM_STEPS of pccd_histogram_kind: STEPS.
function short_name(key, words,    prefix, i, n) {
    prefix = "PCCD_"
    for (i = 2; i in words; i++) {
        if (index(key, prefix toupper(words[i]) "_") != 1)
            break
        prefix = prefix toupper(words[i]) "_"
    }
    return substr(key, length(prefix) + 1)
}

function print_struct(name, body, doc,    list, i, n, one, names, k, m, base, member, count) {
    print "\n\nclass " name "(ctypes.Structure):"
    print_doc(doc)
    print "    _fields_ = ["
    n = split(body, list, ";")
    for (i = 1; i <= n; i++) {
        one = trim(list[i])
        gsub(/[ \t\n]+/, " ", one)
        if (one == "")
            continue
        if (match(one, /\(\*[a-z_]+\)\(/)) {
            member = substr(one, RSTART + 2, RLENGTH - 4)
            base = substr(one, RSTART + RLENGTH)
            sub(/\)$/, "", base)
            print "        (\"" member "\", ctypes.CFUNCTYPE(" \
                type_of(substr(one, 1, RSTART - 1)) parameters(base, 1) ")),"
            continue
        }
        m = split(one, names, ",")
        match(names[1], /[a-z0-9_]+(\[[^]]*\])*$/)
        base = substr(names[1], 1, RSTART - 1)
        names[1] = substr(names[1], RSTART)
        for (k = 1; k <= m; k++) {
            member = trim(names[k])
            sub(/^\*/, "", member) # the pointer is in the base of the first
            count = ""
            if (match(member, /\[/)) {
                count = " * " dimension(substr(member, RSTART + 1, length(member) - RSTART - 1))
                member = substr(member, 1, RSTART - 1)
            }
            print "        (\"" member "\", " type_of(base) count "),"
        }
    }
    print "    ]"
}

function print_typedef(text,    name, result) {
    gsub(/[ \t\n]+/, " ", text)
    if (!match(text, /\(\*[a-z_]+\)\(/))
        fail(text)
    name = substr(text, RSTART + 2, RLENGTH - 4)
    result = substr(text, 9, RSTART - 9)
    text = substr(text, RSTART + RLENGTH)
    sub(/\)$/, "", text)
    callbacks[name] = 1
    print "\n\n" name " = ctypes.CFUNCTYPE(" type_of(result) parameters(text, 1) ")"
}

function keep_prototype(text,    name, result) {
    gsub(/[ \t\n]+/, " ", text)
    if (!match(text, /pccd_[a-z0-9_]+\(/))
        fail(text)
    name = substr(text, RSTART, RLENGTH - 1)
    result = type_of(substr(text, 1, RSTART - 1))
    text = substr(text, RSTART + RLENGTH)
    sub(/\)$/, "", text)
    prototypes = prototypes "    \"" name "\": (" result ", [" \
        substr(parameters(text, 0), 3) "]),\n"
}

function without_comments(text,    at, end) {
    while ((at = index(text, "/*")) > 0) {
        end = index(substr(text, at), "*/")
        text = substr(text, 1, at - 1) " " substr(text, at + end + 1)
    }
    return text
}

# One declaration of the headers, with the comment before it.
function declaration(text, body, doc) {
    text = trim(text)
    if (text ~ /^enum pccd_[a-z_]+$/ && body != "")
        print_enum(substr(text, 6), body, doc)
    else if (text ~ /^struct pccd_[a-z_]+$/)
        body == "" || print_struct(substr(text, 8), body, doc)
    else if (text ~ /^typedef /)
        print_typedef(text)
    else if (text ~ /\)$/)
        keep_prototype(text)
    else if (text != "")
        fail(text)
}

/^# [0-9]+ "/ { is_ours = $3 ~ /(^"|\/)pccd[a-z_]*\.h"$/; next }
/^pccd_abi_version / { version = $2 "." $3 "." $4; next }
/^#/ { next }
is_ours { source = source $0 "\n" }

END {
    if (failed)
        exit 1
    print "\"\"\"abi.py - what pccd.h says, for ctypes. The build has made it; do not edit.\"\"\"\n"
    print "import ctypes\nimport enum\n"
    print "VERSION = \"" version "\"  # of the library that the headers belong to"
    print "LIBRARY_FOLDER = \"" library_folder "\"  # where the build installs it"
    while ((source = trim(source)) != "") {
        if (index(source, "/*") == 1) {
            at = index(source, "*/")
            doc = substr(source, 1, at + 1)
            source = substr(source, at + 2)
            continue
        }
        semicolon = index(source, ";")
        brace = index(source, "{")
        if (brace > 0 && brace < semicolon) {
            end = index(source, "\n};")
            declaration(without_comments(substr(source, 1, brace - 1)),
                without_comments(substr(source, brace + 1, end - brace)), doc)
            source = substr(source, end + 3)
        } else {
            declaration(without_comments(substr(source, 1, semicolon - 1)), "", doc)
            source = substr(source, semicolon + 1)
        }
        doc = ""
    }
    print "\n\nPROTOTYPES = {"
    printf "%s", prototypes
    print "}"
}
