# fit.awk - the exponents of growth: of each curve the slope of the least squares through
# the logarithms of its points in the two upper decades.
#
# awk -F, -f fit.awk x=triangles y=step_ms only=wide minus=0 size.csv
# prints "y, x, exponent, points, factor": y is about factor times x to the exponent. With
# minus=1 y counts from the least that it is below those decades, and points that are less
# than a fifth above it, which is noise, are left out, as are rows whose first column is not
# `only`.

FNR == 1 {
    for (i = 1; i <= NF; i++) at[$i] = i
    next
}
$1 == only {
    xs[++count] = $at[x]
    ys[count] = $at[y]
    if (xs[count] > most) most = xs[count]
}
END {
    from = most / 150
    if (minus) {
        base = "none"
        for (i = 1; i <= count; i++) {
            if (xs[i] < from && (base == "none" || ys[i] < base)) base = ys[i]
        }
    }
    for (i = 1; i <= count; i++) {
        if (xs[i] < from || ys[i] < (minus ? 1.2 * base : 1e-9)) continue
        u = log(xs[i])
        v = log(ys[i] - base)
        n++; su += u; sv += v; suu += u * u; suv += u * v
    }
    if (n < 2 || n * suu == su * su) {
        print y " against " x ": too few points" > "/dev/stderr"
        exit 1
    }
    slope = (n * suv - su * sv) / (n * suu - su * su)
    printf "%s,%s,%.3f,%d,%.6g\n", y, x, slope, n, exp((sv - slope * su) / n)
}
