"""margins.py - claims about margins of the sieve, for gappa to prove.

Room:     tests/unit. Run by test_eng_margins.sh: margins.py SOURCES INTO
Does:     each constant is read from the line of the code that has it, and must stand in
          BOUNDS.md, too. What is computed with floats is written down here once more, in
          the order of the code: INTO/NAME.g claims that it is off by less than the
          margin, of which 6 % are left over, as BOUNDS.md says. Coordinates are 1 at
          most: as each result is off by a part of itself, it holds for all sizes.
"""

import re
import sys
from pathlib import Path

# A file, the constant in it, and what BOUNDS.md says of it, if anything.
CONSTANTS = [
    ("sift.c", r"is_cut \? (?P<cut>\d+) : (?P<cubic>\d+)\) \* ENG_N_U", ""),
    ("sift.c", r"c\) \+ (?P<areas>\d+) \* \(a \* b \+ \(a \+ b\) \* c\)",
     "`{cubic} u24 PBC + {areas} (..)`, times {second_words}, times {third_words}"),
    ("sift.c", r"of_products \* \(a \* b \* c\)", "`{cut} u24 PBC + {areas} (..)`"),
    ("sift.c", r"eng_f_all\((?P<thick>\d+) \* ENG_N_U\)",
     "The code: `{thick} u24`, {areas}, and three times these"),
    ("sift.c", r"length = (?P<length>\d+) \* ENG_N_U \* \(b \* c\) \+ "
     r"(?P<length_areas>\d+) \*", "twice `{half} u24 BC + {half_areas} (B + C)`"),
    ("sift_near.c", r"(?P<near>\d+) \* ENG_N_U \* \(a \* b \* c\) \+ "
     r"(?P<near_areas>\d+) \*", "The code: `{near} u24`, and {near_areas}"),
    ("sift_near.c", r"(?P<normal>\d+) \* ENG_N_U \* \(b \* c\) \+ "
     r"(?P<normal_areas>\d+) \*", "`E = {normal} u24 BC + {normal_areas} (B + C)`"),
    ("reject.c", r"heights_miss\(f, (?P<filter>\d+) \* ENG_U",
     "Margin: `{filter} u PBC`, times {second_words}, times {third_words}"),
    ("reject.h", r"\{error, (?P<second>\d+) \* error, (?P<third>\d+) \* error\}", ""),
    ("reject.h", r"#define OFF_GRID (?P<off_grid>\d+)",
     "the largest computed coordinates plus {off_grid}"),
    ("reject.h", r"#define ENG_SLACK \(1 \+ (?P<slack>\d+) \* ENG_N_U\)",
     "It is `1 + {slack} u24`"),
    ("lanes.h", r"#define ENG_N_U 0x1p-(?P<bits>\d+)f", "`u24 = 2^-{bits}`"),
    ("lanes.h", r"#define ENG_N_U 0x1p-(?P<double_bits>\d+) ", "`u = 2^-{double_bits}`"),
]
WORDS = {6: "six", 12: "twelve"}

# Numbers on the grid are within half a cell, differences within 1.01 (BOUNDS.md, "The
# sieve: the grid"): so much of the products of two of three lengths, or of one of two.
CELL = 1.01
ON_GRID = {"areas": 6 * CELL, "near_areas": 6 * CELL, "normal_areas": 2 * CELL,
           "length_areas": 4 * CELL * 3 ** 0.5, "off_grid": CELL}
LEFT_OVER = 1.06


def text_of(path):
    return " ".join(path.read_text().split())


def read_constants(top):
    """The constants by name, and what is wrong with them."""
    found = {}
    wrong = []
    engine = top / "daemon/engine"
    for name, pattern, _ in CONSTANTS:
        match = re.search(pattern, text_of(engine / "kernel" / name))
        if match:
            found.update((key, int(value)) for key, value in match.groupdict().items())
        else:
            wrong.append(f"{name} has nothing like: {pattern}")
    if wrong:
        return found, wrong
    said = dict(found, half=found["length"] // 2, half_areas=found["length_areas"] // 2,
                second_words=WORDS.get(found["second"], "?"),
                third_words=WORDS.get(found["third"], "?"))
    bounds = text_of(engine / "elementary/BOUNDS.md")
    for name, _, words in CONSTANTS:
        if words.format(**said) not in bounds:
            wrong.append(f"{name}: BOUNDS.md does not say: {words.format(**said)}")
    for name, least in ON_GRID.items():
        if found[name] < LEFT_OVER * least:
            wrong.append(f"{name} is {found[name]}: less than {LEFT_OVER * least:.2f}")
    return found, wrong


# ---- what the code computes: a name for what is rounded, E and the name for the truth --

LETTERS = "xyz"


def operators(bits):
    # Exponents as low as that: nothing that is rounded here is too small for its bits.
    # (add_rel and the like say the same; gappa 1.6.0, of Debian 13, has not their names.)
    return [f"@rnd = float<{bits},-30000,ne>;"]


def add(a, b):
    return f"rnd({a} + {b})"


def sub(a, b):
    return f"rnd({a} - {b})"


def mul(a, b):
    return f"rnd({a} * {b})"


def cross(name, a, b):
    """As eng_v_cross."""
    lines = []
    for i, c in enumerate(LETTERS):
        y, z = LETTERS[(i + 1) % 3], LETTERS[(i + 2) % 3]
        lines += [f"{name}{c} = {sub(mul(a + y, b + z), mul(a + z, b + y))};",
                  f"E{name}{c} = E{a}{y} * E{b}{z} - E{a}{z} * E{b}{y};"]
    return lines


def dot(a, b):
    """As eng_v_dot: rounded, and true."""
    x, y, z = (mul(a + c, b + c) for c in LETTERS)
    true = " + ".join(f"E{a}{c} * E{b}{c}" for c in LETTERS)
    return add(add(x, y), z), f"({true})"


def is_sum(name, first, second):
    return [f"{name} = {add(first[0], second[0])};",
            f"E{name} = {first[1]} + {second[1]};"]


def halves(first, second, third):
    """As heights_miss: of three coefficients, from an end of the step on."""
    return [f"second = {add(mul(3, first), second)};",
            f"Esecond = 3 * E{first} + E{second};",
            f"middle = {add(second, third)};",
            f"Emiddle = E{second} + E{third};",
            f"third = {add('second', 'middle')};",
            "Ethird = Esecond + Emiddle;"]


def cubic(bits):
    """As heights_of and heights_miss, of differences that are rounded once."""
    lines = operators(bits)
    for name, a, b in (("na", "ua", "va"), ("p", "ua", "vb"), ("q", "ub", "va"),
                       ("nc", "ub", "vb")):
        lines += cross(name, a, b)
    lines += [f"nb{c} = {add('p' + c, 'q' + c)}; Enb{c} = Ep{c} + Eq{c};"
              for c in LETTERS]
    height = dot("wa", "na")
    lines += [f"fa = {height[0]}; Efa = {height[1]};"]
    lines += is_sum("fb", dot("wb", "na"), dot("wa", "nb"))
    lines += is_sum("fc", dot("wa", "nc"), dot("wb", "nb"))
    lines += halves("fa", "fb", "fc")
    given = []
    for name in (v + end + c for v in "wuv" for end in "ab" for c in LETTERS):
        given += [f"E{name} in [-1,1]", f"{name} -/ E{name} in [-1b-{bits},1b-{bits}]"]
    return lines, given


# What the coefficients are and what they are off by at most, in u: claimed of `cubic`.
COEFFICIENTS = {"fa": (6, 48), "fb": (18, 180), "fc": (18, 180), "fd": (6, 48)}


def cut(bits):
    """As cut_cubic and heights_miss. The end of the halves at t is off by more."""
    lines = operators(bits) + [f"s = {sub(1, 't')}; Es = 1 - t;"]
    lines += [f"{b} = {mul(f, 'near_third')}; E{b} = E{f} * a_third;"
              for b, f in (("bb", "fb"), ("bc", "fc"))]
    for name, a, b in (("la", "fa", "bb"), ("lb", "bb", "bc"), ("lc", "bc", "fd"),
                       ("ma", "la", "lb"), ("mb", "lb", "lc"), ("end", "ma", "mb")):
        lines += [f"{name} = {add(mul('s', a), mul('t', b))};",
                  f"E{name} = Es * E{a} + t * E{b};"]
    lines += [f"gb = {mul(3, 'la')}; Egb = 3 * Ela;",
              f"gc = {mul(3, 'ma')}; Egc = 3 * Ema;"]
    lines += halves("end", "gc", "gb")
    given = ["t in [0,1]", "a_third in [0.33333,0.33334]",
             f"near_third -/ a_third in [-1b-{bits},1b-{bits}]"]
    for name, (most, off) in COEFFICIENTS.items():
        given += [f"E{name} in [-{most},{most}]",
                  f"{name} - E{name} in [-{off}b-{bits},{off}b-{bits}]"]
    return lines, given


def times(bits, slack):
    """As cut_span and leave_no_time: magnitudes of fractions of whole numbers."""
    lines = operators(bits)
    lines += [f"d = {add('n', 'm')}; Ed = En + Em;",
              f"e = {add('k', 'l')}; Ee = Ek + El;",
              f"later = {mul('n', 'e')};", f"sooner = {mul(mul('k', 'd'), 'slack')};"]
    given = [f"slack in [{slack},{slack}]"]
    for name in "nmkl":
        given += [f"E{name} in [1,1b31]",
                  f"{name} -/ E{name} in [-1b-{bits},1b-{bits}]"]
    return lines, given


# ---- claims ----------------------------------------------------------------------------


def within(bits, units):
    """An interval of so many u on both sides, rounded down."""
    most = int(units * 2 ** 20)
    return f"[-{most}b-{bits + 20},{most}b-{bits + 20}]"


def is_off(bits, **units):
    return [f"{name} - E{name} in {within(bits, n / LEFT_OVER)}"
            for name, n in units.items()]


def claims(c):
    """By name: what is computed and given; what is claimed; how it is split."""
    bits = c["bits"]
    longest = c["length"] / 3 ** 0.5
    units = {name: COEFFICIENTS[name][1] * LEFT_OVER for name in ("fa", "fb", "fc")}

    def of_halves(own_bits, end, margin):
        return is_off(own_bits, **{end: margin, "second": c["second"] * margin,
                                   "third": c["third"] * margin})

    slack = f"{2 ** bits + c['slack']}b-{bits}"
    share = within(bits, c["slack"] / LEFT_OVER / 2)
    return {
        "coefficients": (cubic(bits), is_off(bits, **units), ""),
        "cubic": (cubic(bits), of_halves(bits, "fa", c["cubic"]), ""),
        "filter": (cubic(c["double_bits"]),
                   of_halves(c["double_bits"], "fa", c["filter"]), ""),
        "cut": (cut(bits), of_halves(bits, "end", c["cut"]), "$ t in 32;"),
        "thick": (cubic(bits), is_off(bits, fa=c["thick"], fb=3 * c["thick"], nax=longest,
                                      nbx=longest), ""),
        "near": (cubic(bits), is_off(bits, fa=c["near"], nax=c["normal"]), ""),
        "times": (times(bits, slack), [f"later -/ (En * Ee) in {share}",
                                       f"sooner -/ (Ek * Ed * slack) in {share}"], ""),
    }


def main():
    constants, wrong = read_constants(Path(sys.argv[1]))
    for line in wrong:
        print(line)
    if wrong:
        return 1
    for name, ((lines, given), goals, split) in claims(constants).items():
        logic = " /\\\n".join(given) + "\n->\n" + " /\\\n".join(goals)
        text = "\n".join(lines) + "\n{ " + logic + " }\n" + split + "\n"
        (Path(sys.argv[2]) / f"{name}.g").write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
