# table.awk - measured.csv to the paper's Table 1, as Markdown.
#
# awk -F, -f table.awk measured.csv >table1.md

function cell(scheduler, p) { return ms[scene[s], scheduler, p] }

BEGIN {
    title["cloth"] = "Cloth simulation"; paper["cloth"] = "92 K, 465, 56"
    title["breaking"] = "Breaking dragon"; paper["breaking"] = "252 K, 480, 130"
    title["bodies"] = "N-body simulation"; paper["bodies"] = "146 K, 375, 138"
}

NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }

{
    name = $at["scene"]; p = $at["p"]
    if (!(name in triangles)) scene[++scenes] = name
    if (!(p in is_p)) { is_p[p] = 1; threads[++counts] = p }
    triangles[name] = $at["triangles"]
    steps[name] = $at["steps"]
    contacts[name] = $at["contacts"]
    ms[name, $at["scheduler"], p] = $at["ms"]
}

END {
    head = "| scene | triangles | steps | contacts a step"
    line = "|---|---|---|---"
    for (i = 1; i <= counts; i++) {
        head = head sprintf(" | paper's method, %d", threads[i])
        line = line "|---"
    }
    for (i = 1; i <= counts; i++) {
        head = head sprintf(" | wide, %d", threads[i])
        line = line "|---"
    }
    print head " | published: triangles, frames, ms by eight |"
    print line "|---|"
    for (s = 1; s <= scenes; s++) {
        name = scene[s]
        row = sprintf("| %s | %d | %d | %.0f", name in title ? title[name] : name, \
            triangles[name], steps[name], contacts[name])
        for (i = 1; i <= counts; i++) row = row sprintf(" | %.1f ms", cell("paper", threads[i]))
        for (i = 1; i <= counts; i++) row = row sprintf(" | %.1f ms", cell("wide", threads[i]))
        print row " | " (name in paper ? paper[name] : "") " |"
    }
}
