# ranks.awk - the model of ranks: from what few ranks were counted and timed with to what many
# would have, send and take.
#
# awk -F, -v scene=SCENE/PARTS -f ranks.awk threads.csv memory.csv link.csv counts.csv rates.csv choices.csv times.csv
#
# The files are those of ranks.sh; README.md, "Ranks", says what the model is. Prints the tables
# of that page, and ends with 1 if what was counted does not add up, or what is predicted cannot be.

function wrong(text) { print "WRONG: " text > "/dev/stderr"; bad = 1 }
function most(a, b) { return a > b ? a : b }
function least_of(a, b) { return a + 0 < b + 0 ? a : b }
function log2(x) { return log(x) / log(2) }

# ---- reading -----------------------------------------------------------------------------

FNR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
FILENAME ~ /threads/ {
    if ($at["scheduler"] == "wide" && $1 !~ /\//) faster[$at["p"]] = least_of($at["speedup"], $at["p"])
    next
}
FILENAME ~ /memory/ { bytes_of_rank[$1] = $2; triangles_of_rank[$1] = $3; next }
FILENAME ~ /link/ { link[$1] = $2; next }
{
    # A scene is its name and how small its steps are; a run is one number of ranks.
    scene = $1 "/" $at["parts"]
    n = $at["triangles"]; R = $at["ranks"]; step = $at["step"]; how = $at["how"]
    run = FILENAME SUBSEP scene SUBSEP n SUBSEP R
    if (!(run in steps)) known[++run_count] = run
    if (step != steps[run]) begin_step()
    r = $at["rank"]
    own[run] += $at["own"]; ghosts[run] += $at["ghosts"]; records[run] += $at["records"]
    here[run] += $at["own_vertices"] + $at["ghost_vertices"]
    leaves[run, r] = $at["own"] + $at["ghosts"]
    sent[run] += $at["sent"]
    evenly[run] += $at["work"]
    busiest[run] = most(busiest[run], $at["work"])
    work[run] += work_at[run, r] = $at["work"] - LEAF_WORK * leaves[run, r]
    largest[run] = most(largest[run], leaves[run, r])
    vertices_at[run, r] = $at["own_vertices"] + $at["ghost_vertices"]
    records_at[run, r] = $at["records"]
    sent_at[run, r] = $at["sent"]
    wall[run] = most(wall[run], $at["wall_ns"])
    if (r == R - 1) end_step()
}
function begin_step() {
    steps[run] = step
    own[run] = ghosts[run] = records[run] = here[run] = sent[run] = work[run] = evenly[run] = 0
    busiest[run] = largest[run] = wall[run] = 0
}
function end_step(  was) {
    name = scene SUBSEP n SUBSEP step SUBSEP how
    if (own[run] != n) wrong("step " step " of " scene " on " R " ranks: " own[run] " of " n " triangles")
    if (records[run] != $at["total"]) wrong("step " step " of " scene " on " R " ranks: records are lost")
    if ((name in hash) && hash[name] != $at["hash"]) wrong("step " step " of " scene " on " R " ranks: other bytes")
    hash[name] = $at["hash"]
    is_plain = $at["searches"] == searches[run] && $at["cuts"] == cuts[run]
    if (is_plain && sent[run] > 24 * here[run]) wrong("more was sent than anybody needs: " scene " on " R)
    if (is_plain) keep(run SUBSEP how, wall[run])
    if (!is_plain && step > 1 && $at["cuts"] == cuts[run]) {
        keep(run SUBSEP "search", wall[run])
        search_sent[run] = sent[run]
    }
    if (how == "on" && step > LATE) {
        late_steps[run]++
        late_ghosts[run] += ghosts[run]
        late_searches[run] += $at["searches"] != searches[run] && $at["cuts"] == cuts[run]
    } else if (how == "on" && step > 1) {
        early_steps[run]++
        early_searches[run] += $at["searches"] != searches[run] && $at["cuts"] == cuts[run]
    }
    cuts[run] = $at["cuts"]; searches[run] = $at["searches"]; scene_vertices[run] = $at["vertices"]
    if (is_plain && how != "on") {
        keep(run SUBSEP how "refit", $at["ingest_ns"] + $at["refit_ns"])
        keep(run SUBSEP how "tests", $at["traversal_ns"] + $at["tests_ns"])
        keep(run SUBSEP how "merge", $at["merge_ns"])
    }
}

# ---- writing -----------------------------------------------------------------------------

function head(text, names,  name, count, i) {
    printf "\n%s\n\n|", text
    count = split(names, name, ",")
    for (i = 1; i <= count; i++) printf " %s |", name[i]
    printf "\n|"
    for (i = 1; i <= count; i++) printf "---|"
    print ""
}
# 12 345, as the pages have it.
function spaced(x,  text) {
    x = sprintf("%d", x)
    for (; length(x) > 3; x = substr(x, 1, length(x) - 3)) text = " " substr(x, length(x) - 2) text
    return x text
}
function off(said, got) { return sprintf("%+.0f %%", 100 * (said / got - 1)) }

# ---- medians -----------------------------------------------------------------------------

function keep(list, value) { values[list, ++length_of[list]] = value }
function median(list,  i, j, x) {
    for (i = 2; i <= length_of[list]; i++) {
        x = values[list, i]
        for (j = i - 1; j > 0 && values[list, j] > x; j--) values[list, j + 1] = values[list, j]
        values[list, j + 1] = x
    }
    return values[list, int((length_of[list] + 1) / 2)]
}

# ---- constants: from one rank ------------------------------------------------------------

function run_of(file, scene, n, R) { return file SUBSEP scene SUBSEP n SUBSEP R }
function split_run(run,  part) {
    split(run, part, SUBSEP)
    file = part[1]; scene = part[2]; n = part[3]; R = part[4]
}
# Of a run, what is beside libpccd's phases.
function rest_of(run) {
    return median(run SUBSEP "fro") - median(run SUBSEP "frorefit") - median(run SUBSEP "frotests") - median(run SUBSEP "fromerge")
}
# A record beside libpccd: one rank, two series of the same meshes that differ most in records.
function measure_record(  i, k, one, many, more) {
    for (i = 1; i <= run_count; i++) for (k = 1; k <= run_count; k++) {
        one = known[i]; many = known[k]
        split(one, part, SUBSEP); split_run(many)
        if (file !~ /times/ || part[1] != file || n != part[3] || R != 1 || part[4] != 1) continue
        if (records[many] - records[one] <= more) continue
        more = records[many] - records[one]
        record_ns = most(0, (rest_of(many) - rest_of(one)) / more)
    }
}
# Of a sheet alone, that meets nothing: what a vertex takes in each of two ranks more than in one.
function measure_looks(  i, r, vertices, bytes, rest, took) {
    for (i = 1; i <= run_count; i++) {
        split_run(known[i])
        if (scene !~ /^sheet/) continue
        vertices = bytes = 0
        for (r = 0; r < R; r++) {
            vertices = most(vertices, vertices_at[known[i], r])
            bytes = most(bytes, sent_at[known[i], r])
        }
        rest = rest_of(known[i]) - exchange_ns(R, bytes, link["link_latency_ns"], link["link_byte_ns"])
        took[R] = rest / vertices
    }
    look_ns = most(0, took[2] - took[1]) # of a tiny sheet it is noise
}
function measure_constants(  i, key, one) {
    measure_record()
    measure_looks()
    for (i = 1; i <= run_count; i++) {
        split_run(known[i])
        one = known[i]
        if (file !~ /times/ || R != 1 || scene ~ /^sheet/ || !length_of[one, "fro"]) continue
        key = scene SUBSEP n
        whole_ns[key] = median(one SUBSEP "fro")
        leaf_ns[key] = median(one SUBSEP "frorefit") / n
        work_ns[key] = median(one SUBSEP "frotests") / work[one]
        merge_ns[key] = records[one] ? median(one SUBSEP "fromerge") / records[one] : 0
        vertex_ns[key] = most(0, rest_of(one) - record_ns * records[one]) / scene_vertices[one]
        slower[key] = length_of[one, "alone"] ? median(one SUBSEP "alone") / whole_ns[key] : 1
    }
}

# ---- what ranks take ---------------------------------------------------------------------

# The own time of one of R ranks, which `threads` of it share. Of more ranks each looks, too, whether
# vertices leave their boxes, and packs those that others need.
function compute_ns(R, key, leaves, work, vertices, records, threads) {
    return (leaf_ns[key] * leaves + work_ns[key] * work + merge_ns[key] * records + \
        (vertex_ns[key] + (R > 1 ? look_ns : 0)) * vertices + record_ns * records) / faster[threads]
}
# Numbers of all ranks, COLLECTIVES times a step, and positions, to each rank at worst.
function exchange_ns(R, bytes, latency_ns, byte_ns) {
    if (R == 1) return 0
    return (COLLECTIVES * log2(R) + R - 1) * latency_ns + bytes * byte_ns
}

function predict_two(  i, key, r, run, longest, said, got) {
    head("Two ranks, ms a step. *slowed*: what two processes take from each other that have a scene each.",
        "scene,triangles,one rank,slowed,two: predicted,measured,off")
    for (i = 1; i <= run_count; i++) {
        run = known[i]
        split_run(run)
        key = scene SUBSEP n
        if (file !~ /times/ || R != 2 || !(key in whole_ns)) continue
        longest = 0
        for (r = 0; r < R; r++) {
            longest = most(longest, compute_ns(R, key, leaves[run, r], work_at[run, r], vertices_at[run, r],
                records_at[run, r], 1) * slower[key] + sent_at[run, r] * link["link_byte_ns"])
        }
        said = longest + exchange_ns(R, 0, link["link_latency_ns"], 0)
        got = median(run SUBSEP "fro")
        printf "| %s | %s | %.2f | %.2f | %.2f | %.2f | %s |\n", scene, spaced(n), whole_ns[key] / 1e6, slower[key],
            said / 1e6, got / 1e6, off(said, got)
    }
    for (i = 1; i <= run_count; i++) {
        run = known[i]
        split_run(run)
        if (file !~ /choices/ || !length_of[run, "search"]) continue
        said = median(run SUBSEP "search") - median(run SUBSEP "on")
        search_ns[scene] = said / largest[run]
        printf "\n%s, %s triangles on two ranks: to choose ghosts anew takes %.0f ns a triangle of a rank, as long as %.1f steps " \
            "(median of %d).\n", scene, spaced(n), search_ns[scene], said / median(run SUBSEP "on"), length_of[run, "search"]
    }
}

# ---- what ranks have ---------------------------------------------------------------------

# A piece of a surface, as a square of `own` leaves: ghosts are what a rim around it adds. The
# rim is in sides of leaves.
function ghosts_by(rim, own) { return 2 * rim * sqrt(own) + rim * rim }
function ghosts_of(scene, own) { return ghosts_by(rim[scene], own) }
# Of all work, what one process has not.
function extra_of(scene, own) { return extra[scene] * ghosts_by(fitted_rim[scene], own) / own }
function bytes_of(scene, R, own) {
    return 24 * a_leaf[scene] * (own + ghosts_of(scene, own)) * (1 - 1 / R)
}
# The same where ghosts are chosen: beside positions and numbers of vertices, of each 16
# leaves a box of 60 bytes to all.
function blocks_of(own, R) { return least_of(own / 16, most(256, least_of(32768, 1048576 / R))) }
function search_bytes_of(scene, R, own) {
    return searched[scene] * (own + ghosts_of(scene, own)) * (1 - 1 / R) + 60 * blocks_of(own, R) * (R - 1)
}
# The largest work of a rank beside the mean: what is wrong with weights is at the rim of a piece.
function uneven_of(scene, own) { return 1 + uneven[scene] / sqrt(own) }
function one_work(scene, n, file,  run) {
    run = run_of(file, scene, n, 1)
    return (run in work) ? work[run] : work_a_leaf[scene] * n
}
# From runs of 4 and 8 ranks, of the largest size of a scene that 8 have, or else 4.
function fit_laws(  i, run, most_ranks) {
    for (most_ranks = 4; most_ranks <= 8; most_ranks += 4) for (i = 1; i <= run_count; i++) {
        split_run(known[i])
        if (file !~ /counts/ || R != most_ranks || (fitted_by[scene] == R && n < fitted[scene])) continue
        fitted[scene] = n
        fitted_by[scene] = R
    }
    for (i = 1; i <= run_count; i++) {
        run = known[i]
        split_run(run)
        if (file !~ /counts/) continue
        if (R == 1) work_a_leaf[scene] = work[run] / n
        if (n != fitted[scene] || (R != 4 && R != 8)) continue
        fits[scene]++
        rim[scene] += sqrt((n + ghosts[run]) / R) - sqrt(n / R)
        a_leaf[scene] += here[run] / (n + ghosts[run])
        if (search_sent[run]) searched[scene] += (search_sent[run] - 60 * blocks_of(n / R, R) * R * (R - 1)) / (n + ghosts[run]) / (1 - 1 / R)
        extra[scene] += (work[run] / work[run_of(file, scene, n, 1)] - 1) * n / ghosts[run]
    }
    for (i = 1; i <= run_count; i++) { # smaller pieces are not modelled
        run = known[i]
        split_run(run)
        if (file ~ /counts/ && R >= 8 && n / R >= 1e4)
            uneven[scene] = most(uneven[scene], (busiest[run] * R / evenly[run] - 1) * sqrt(n / R))
    }
    for (scene in fits) {
        fitted_rim[scene] = rim[scene] /= fits[scene]
        a_leaf[scene] /= fits[scene]
        searched[scene] /= fits[scene]
        extra[scene] /= fits[scene]
    }
}
# How often ghosts are chosen, and the rim that they have when room has grown.
function find_rates(  i, run, ghosts_now, rim_now) {
    for (i = 1; i <= run_count; i++) {
        run = known[i]
        split_run(run)
        if (file !~ /rates/ || !late_steps[run]) continue
        often[scene] = late_searches[run] / late_steps[run]
        ghosts_now = late_ghosts[run] / late_steps[run]
        rim_now = sqrt((n + ghosts_now) / R) - sqrt(n / R)
        printf "\n%s, %s triangles on %d ranks: ghosts are chosen %.3f times a step in the first %d, %.3f times in the next %d; " \
            "there they are %.0f %% of own triangles, a rim of %.1f.\n", scene, spaced(n), R, early_searches[run] / early_steps[run],
            LATE, often[scene], late_steps[run], 100 * ghosts_now / n, rim_now
        rim[scene] = rim_now
    }
}
function compare_counts(  i, run, got) {
    head("Counted with real ranks, and how far off the model is; means of a rank, a step. *fitted*: from these the model has its numbers.",
        "scene,triangles,ranks,ghosts,of own,off,KB sent,off,KB if ghosts are chosen,off,box tests and survivors of all / of one process,off,largest work / mean,off,fitted")
    for (i = 1; i <= run_count; i++) {
        run = known[i]
        split_run(run)
        if (file !~ /counts/ || R == 1 || !(scene in rim)) continue
        printf "| %s | %s | %d | %s | %.0f %% | %s | %.0f | %s |", scene, spaced(n), R, spaced(ghosts[run] / R), 100 * ghosts[run] / n,
            off(ghosts_of(scene, n / R), ghosts[run] / R), sent[run] / R / 1e3, off(bytes_of(scene, R, n / R), sent[run] / R)
        got = search_sent[run] / R
        if (got && searched[scene]) printf " %.0f | %s |", got / 1e3, off(search_bytes_of(scene, R, n / R), got); else printf " | |"
        got = work[run] / one_work(scene, n, file)
        printf " %.3f | %s | %.3f | %s | %s |\n", got, off(1 + extra_of(scene, n / R), got), busiest[run] * R / evenly[run],
            off(uneven_of(scene, n / R), busiest[run] * R / evenly[run]), n == fitted[scene] && (R == 4 || R == 8) ? "yes" : ""
    }
}

# ---- what many would take ----------------------------------------------------------------

# A step of n triangles on `nodes` machines of so many ranks, each of so many threads; Gbit/s and
# microseconds of the network. Sets step_ns and its parts.
function predict(scene, n, nodes, each, threads, gbit, latency_us,  R, key, mean, all_ns) {
    R = nodes * each
    key = scene SUBSEP large[scene]
    mean = n / R
    ghosts_now = ghosts_of(scene, mean)
    records_now = n / R * density[scene]
    work_now = work_a_leaf[scene] * mean * (1 + extra_of(scene, mean))
    even_ns = compute_ns(R, key, mean + ghosts_now, work_now, a_leaf[scene] * (mean + ghosts_now), records_now, threads)
    step_compute = even_ns * uneven_of(scene, mean) * (each * threads > 1 ? slower[key] : 1)
    bytes_now = bytes_of(scene, R, mean)
    step_exchange = exchange_ns(R, each * bytes_now, 1e3 * latency_us, 8 / gbit)
    step_search = often[scene] * (search_ns[scene] * (mean + ghosts_now) + R * log2(R) * 1e3 * latency_us + \
        each * search_bytes_of(scene, R, mean) * 8 / gbit)
    step_ns = step_compute + step_exchange + step_search
    all_ns = compute_ns(1, key, n, work_a_leaf[scene] * n, a_leaf[scene] * n, n * density[scene], 1)
    efficiency = all_ns / (step_ns * R * threads)
    efficiency_without = all_ns / ((step_compute + step_exchange) * R * threads)
    if (step_ns * R * threads < all_ns * 0.999) wrong(n " triangles on " R " ranks: faster than its work")
    return step_ns
}
function extrapolate(  i, k, size, nodes, sizes, ways, part) {
    scene = MODEL_SCENE
    for (i = 1; i <= run_count; i++) { # constants of the largest that was timed
        split_run(known[i])
        if (scene == MODEL_SCENE && ((scene SUBSEP n) in whole_ns) && n > large[scene]) {
            large[scene] = n
            density[scene] = records[known[i]] / n
        }
    }
    scene = MODEL_SCENE
    if (!large[scene]) { wrong("no times of " scene); return }
    head(sprintf("%s, ms a step, at %d Gbit/s and %g us; ghosts are chosen %.3f times a step; " \
        "a rank takes %.0f MB and %.0f bytes a triangle. *efficiency*: beside one thread that has all; in brackets without choosing ghosts.",
        scene, GBIT, LATENCY_US, often[scene], base_bytes / 1e6, triangle_bytes),
        "triangles,nodes,ranks,threads of each,own,ghosts,MB sent,compute,exchange,choose ghosts,step,efficiency,GB of a node")
    sizes = split("1e6 1e7 1e8 1e9", size, " ")
    ways = split("64:1:1 64:64:1 64:16:4 64:8:8 64:4:16 64:1:64", part, " ")
    for (i = 1; i <= sizes; i++) for (k = 1; k <= ways; k++) {
        split(part[k], way, ":")
        R = way[1] * way[2]
        if (size[i] / R < 5e3) continue
        predict(scene, size[i], way[1], way[2], way[3], GBIT, LATENCY_US)
        printf "| 10^%d | %d | %d | %d | %s | %.1f %% | %.2f | %.2f | %.2f | %.2f | %.2f | %.0f %% (%.0f %%) | %.2f |\n",
            log(size[i]) / log(10) + 0.5, way[1], R, way[3], spaced(size[i] / R), 100 * ghosts_now * R / size[i],
            bytes_now / 1e6, step_compute / 1e6, step_exchange / 1e6, step_search / 1e6, step_ns / 1e6, 100 * efficiency,
            100 * efficiency_without, way[2] * (base_bytes + triangle_bytes * (size[i] / R + ghosts_now)) / 1e9
    }
    head("The same by the network: ms a step of 64 nodes, with 8 ranks of 8 threads each.", "triangles,Gbit/s,1 us,2 us,10 us")
    for (i = 2; i <= sizes; i++) for (k = 1; k <= 3; k++) {
        gbit = k == 1 ? 10 : k == 2 ? 25 : 100
        printf "| 10^%d | %d | %.2f | %.2f | %.2f |\n", log(size[i]) / log(10) + 0.5, gbit,
            predict(scene, size[i], 64, 8, 8, gbit, 1) / 1e6, predict(scene, size[i], 64, 8, 8, gbit, 2) / 1e6,
            predict(scene, size[i], 64, 8, 8, gbit, 10) / 1e6
    }
}

BEGIN {
    LATE = 41 # steps after which the room for ghosts has grown
    COLLECTIVES = 10 # MPI_Iallgather and MPI_Iallreduce of a step that needs no new ghosts
    LEAF_WORK = 3 # of share.work what client/mpi/balance.c adds for a leaf, which refit takes
    GBIT = 100
    LATENCY_US = 2
    MODEL_SCENE = scene
}
END {
    faster[1] = 1
    triangle_bytes = (bytes_of_rank["few"] - bytes_of_rank["many"]) / (triangles_of_rank["few"] - triangles_of_rank["many"])
    base_bytes = bytes_of_rank["few"] - triangle_bytes * triangles_of_rank["few"]
    measure_constants()
    head("Measured with one rank, ns: a triangle, to be refitted; a unit of work; a record; a vertex beside libpccd",
        "scene,triangles,refit,work,record,vertex")
    for (i = 1; i <= run_count; i++) {
        split_run(known[i])
        key = scene SUBSEP n
        if (file ~ /times/ && R == 1 && (key in whole_ns)) {
            printf "| %s | %s | %.1f | %.1f | %.0f | %.1f |\n", scene, spaced(n), leaf_ns[key], work_ns[key], merge_ns[key],
                vertex_ns[key]
        }
    }
    printf "\nA record beside libpccd, %.1f ns; a vertex in each of more ranks, %.1f more; a message between two ranks here, %.0f ns, " \
        "and %.3f a byte.\n", record_ns, look_ns, link["link_latency_ns"], link["link_byte_ns"]
    predict_two()
    fit_laws()
    compare_counts()
    find_rates()
    extrapolate()
    exit bad
}
