#!/usr/bin/python3
"""Generates BENCHMARKS.md and results/TABLES.md from the rows in tests/bench/results and the text in two templates there.

usage: make_benchmarks.py [--check]

A line "@table NAME" of a template becomes the table that the function NAME below makes, and "@source FILE" the command,
commit and machine of results/FILE.csv. --check: writes nothing; exit code 1 where a page is not what it should be.
"""
import argparse
import difflib
import os
import statistics
import sys

sys.dont_write_bytecode = True  # nothing is written into the sources
import result_files  # noqa: E402

USUAL_MACHINE = "AMD EPYC, 2 cores shared with other work"  # each template names it once
PAGES = {"benchmarks.template.md": "BENCHMARKS.md", "tables.template.md": "tests/bench/results/TABLES.md"}


def rows_of(name, **wanted):
    """Rows of a file, those with the wanted values."""
    _, rows = result_files.read(os.path.join(result_files.FOLDER, name + ".csv"))
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def grouped(text):
    return f"{float(text):,.0f}"


def scientific(text):
    """1.9e-05 as 1.9e-5, 1e-05 as 1e-5."""
    mantissa, exponent = f"{float(text):.1e}".split("e")
    return f"{mantissa.removesuffix('.0')}e{int(exponent)}"


def fixed(digits):
    return lambda text: f"{float(text):.{digits}f}"


def plain(text):
    return text


def columns(rows, *asked):
    """A table of some columns: (heading, column of the file, how it is written)."""
    return [[heading for heading, _, _ in asked]] + [[shown(row[key]) if row[key] else "" for _, key, shown in asked] for row in rows]


def scenes():
    return columns(rows_of("scenes"), ("scene", "scene", plain), ("polygons", "polygons", grouped), ("cells", "cells", plain),
                   ("visible %", "visible_percent", fixed(2)), ("pixel error", "pixel_error", scientific),
                   ("95 % upper bound", "upper_bound", scientific), ("CPU s per cell", "bake_cpu_seconds_per_cell", fixed(2)),
                   ("bits per visible polygon", "bits_per_visible_polygon", fixed(2)))


def whole_bakes():
    return columns(rows_of("whole_bakes"), ("scene", "scene", plain), ("polygons", "polygons", grouped), ("cells", "cells", grouped),
                   ("visible %", "visible_percent", fixed(2)), ("CPU s", "cpu_seconds", grouped), ("of a cell: median", "median", fixed(2)),
                   ("longest", "longest", fixed(2)), ("largest bound", "largest_bound", scientific), ("file, KB", "bytes", kilobytes))


def frames():
    """A row per scene: what is drawn, and frames, for frustum culling alone and with the PVS."""
    table = [["scene", "polygons", "in the frustum", "in the frustum and the PVS", "times fewer", "frame ms, frustum", "frame ms, both",
              "times less", "wrong pixels, mean", "most"]]
    for everything in rows_of("frames", method="full"):
        frustum, = rows_of("frames", method="frustum", scene=everything["scene"])
        ours, = rows_of("frames", method="pvs_frustum", scene=everything["scene"])

        def times(key):
            return f"{float(frustum[key]) / float(ours[key]):.1f}"

        table.append([everything["scene"], *(grouped(row["polygons"]) for row in (everything, frustum, ours)), times("polygons"),
                      *(fixed(1)(row["frame_ms_median"]) for row in (frustum, ours)), times("frame_ms_median"),
                      scientific(ours["pixel_error_mean"]), scientific(ours["pixel_error_max"])])
    return table


def q3map2():
    return columns(rows_of("q3map2"), ("level", "level", plain), ("cells", "cells", plain),
                   ("faces of our sets", "faces", grouped), ("outside q3map2's sets", "outside", plain),
                   ("size over q3map2's", "size_ratio", fixed(2)))


def targets():
    return columns(rows_of("targets", scene="all"), ("bound", "target", scientific), ("cells", "cells", plain),
                   ("met", "met_by_truth", plain), ("hemicubes", "hemicubes", plain), ("M rays", "million_rays", fixed(1)),
                   ("CPU s, median", "cpu_seconds_median", fixed(2)), ("most", "cpu_seconds_worst", fixed(1)),
                   ("pixel error", "pixel_error_mean", scientific), ("polygons seen", "polygons_in_set", grouped))


def coverage():
    return columns(rows_of("coverage"), ("scene", "scene", plain), ("bound", "target", scientific), ("bounds", "bounds", plain),
                   ("above the truth", "hold", plain), ("error / bound, largest", "error_over_bound_largest", fixed(2)))


def reach_spawns():
    return columns(rows_of("reach_spawns"), ("level", "scene", plain), ("spawns", "spawns", plain),
                   ("with a floor below", "with_floor", plain), ("in a cell", "in_cells", plain))


def reach_walks():
    return columns(rows_of("reach_walks"), ("scene", "scene", plain), ("steps", "steps", grouped), ("in no cell", "outside", grouped),
                   ("of these beyond the searched heights", "beyond_heights_of_cells", grouped),
                   ("in no column before merging", "outside_before_merging", grouped), ("cells visited", "cells_visited", grouped),
                   ("of", "cells", grouped))


def reach_sizes():
    """Cells of one size beside the automatic ones of the same region."""
    table = [["scene", "quality", "cells", "number", "CPU s", "KB", "polygons drawn", "automatic cells: times fewer",
              "times the polygons"]]
    for row in rows_of("reach_sizes") + rows_of("reach_sizes_draft"):
        file = "reach_sizes" if row["quality"] == "normal" else "reach_sizes_draft"
        automatic, = rows_of(file, scene=row["scene"], cells_are="merged")
        ratios = ["", ""]
        if row["cells_are"] != "merged":
            ratios = [f"{float(row['stored']) / float(automatic['stored']):.1f}",
                      f"{float(automatic['drawn']) / float(row['drawn']):.2f}"]
        name = {"merged": "automatic", "columns": "columns of 4 m", "lattice": "4 x 2 x 4 m"}[row["cells_are"]]
        table.append([row["scene"], row["quality"], name, grouped(row["stored"]), fixed(0)(row["cpu_seconds"]),
                      kilobytes(row["bytes"]), grouped(row["drawn"]), *ratios])
    return table


def equal_time():
    """All cells; a setting's best number of pixels at each time."""
    best = {}
    for row in rows_of("equal_time", scene="all"):
        name = row["setting"].split()[0]
        known = best.setdefault(name, {})
        if row["seconds"] not in known or float(row["pixel_error"]) < float(known[row["seconds"]]):
            known[row["seconds"]] = row["pixel_error"]
    times = ["0.5", "1", "2"]
    return [["sampler"] + [f"{t} s" for t in times]] + [[name] + [scientific(of[t]) for t in times] for name, of in best.items()]


def samplers():
    rows = rows_of("samplers_pooled", scene="vienna800k", kind="samples")
    rows = [dict(row, method=row["method"] + (", jittered" if row["best"] == "1" else ""),
                 spent=row["hemicubes"] or row["million_rays"] + " M rays") for row in rows]
    return columns(rows, ("sampler", "method", plain), ("hemicubes or rays", "spent", plain), ("CPU s per cell", "cpu_seconds", fixed(2)),
                   ("visible %", "visible_percent", fixed(2)), ("pixel error", "pixel_error", scientific))


def hemicubes():
    return columns(rows_of("hemicubes_street"), ("scene", "scene", plain), ("polygons seen", "polygons_seen", grouped), ("cpu, ms", "cpu_ms", fixed(1)),
                   ("llvmpipe, ms", "gpu_ms", fixed(1)), ("Embree, ms", "rays_ms", fixed(1)))


def agreement():
    table = [["source", "pixels", "other polygon than the ray", "of these in the same place", "rest", "share"]]
    for source in ("cpu", "gpu"):
        rows = rows_of("agreement", source=source)
        sums = [sum(int(row[key]) for row in rows) for key in ("pixels", "differ", "same_place", "rest")]
        table.append([source, *(f"{v:,}" for v in sums), scientific(sums[3] / sums[0])])
    return table


def files():
    return columns(rows_of("format_bytes"), ("scene", "scene", plain), ("cells", "cells", grouped),
                   ("bits per visible polygon", "bits_per_visible_polygon", fixed(2)), ("file, bytes", "file_bytes", grouped),
                   ("CRoaring + zstd", "roaring_zstd_over_rows", fixed(1)), ("runs + zstd + dictionary", "dictionary_over_rows", fixed(1)),
                   ("zstd of all sets", "whole_file_over_rows", fixed(1)))


def profiles():
    table = [["profile", "file over exact, median", "ranges over exact, median", "invisible polygons added"]]
    for name, most in (("balanced", "up to 5 %"), ("small", "up to 10 %")):
        rows = rows_of("format_profiles", profile=name)
        table.append([name, *(f"{statistics.median(float(row[key]) for row in rows):.2f}" for key in ("file", "ranges")), most])
    return table


def decoding():
    return columns(rows_of("decoding"), ("scene", "scene", plain), ("to ranges, us", "to_ranges_us", fixed(1)),
                   ("to index list, us", "to_index_list_us", fixed(1)), ("memcpy of the list, us", "memcpy_us", fixed(1)),
                   ("CRoaring to ids, us", "roaring_us", fixed(1)))


def lookups():
    rows = [row for row in rows_of("lookups") if int(row["cells"]) > 100_000]
    return columns(rows, ("cells are", "cells_are", plain), ("cells", "cells", grouped), ("bytes per cell", "bytes_per_cell", fixed(1)),
                   ("random viewpoint, ns", "random_ns", fixed(0)), ("along a path, ns", "along_a_path_ns", fixed(0)),
                   ("frame in its cell, ns", "frame_in_its_cell_ns", fixed(0)))


def kilobytes(text):
    return f"{float(text) / 1000:,.0f}"


def fixed_kilobytes(text):
    return f"{float(text) / 1000:,.1f}"


def streaming():
    """What our order of pages takes, a row per scene."""
    return columns(rows_of("streaming", order="ours"), ("scene", "scene", plain), ("KB until 99 %", "bytes_99", kilobytes),
                   ("99.9 %", "bytes_99_9", kilobytes), ("s until 99 %", "seconds_99", fixed(2)), ("99.9 %", "seconds_99_9", fixed(2)),
                   ("pages over oracle", "over_oracle_99", fixed(2)), ("pages over projected area", "over_area_99", fixed(2)))


def streaming_orders():
    return columns(rows_of("streaming"), ("scene", "scene", plain), ("order", "order", plain), ("KB until 95 %", "bytes_95", kilobytes),
                   ("99 %", "bytes_99", kilobytes), ("99.9 %", "bytes_99_9", kilobytes), ("100 %", "bytes_100", kilobytes),
                   ("before pages", "startup_bytes", kilobytes), ("pages over oracle, 99 %", "over_oracle_99", fixed(2)),
                   ("over projected area", "over_area_99", fixed(2)), ("waste, %", "waste_99_percent", fixed(0)),
                   ("s until 99 %", "seconds_99", fixed(2)), ("99.9 %", "seconds_99_9", fixed(2)))


def streaming_tried():
    """A row per scene."""
    asked = (("ours", "ours"), ("16 times if any heading is in view", "ours_sixteen_times"),
             ("without headings", "ours_boxes_alone"), ("pages in view first", "ours_view_first"),
             ("boxes of draws", "ours_boxes_of_draws_first"),
             ("weights of the viewpoint", "weight_at_pose"), ("knows which pages show anything", "truth_in_view"),
             ("oracle", "oracle"), ("single polygons", "single polygons"))
    table = [["scene"] + [heading for heading, _ in asked]]
    for scene in dict.fromkeys(row["scene"] for row in rows_of("streaming_tried")):
        found = {row["order"]: row["page_bytes_99"] for row in rows_of("streaming_tried", scene=scene)}
        table.append([scene] + [f"{float(found[name]) / 1000:.1f}" for _, name in asked])
    return table


def streaming_encodings():
    return columns(rows_of("streaming_encodings", order="ours"), ("scene", "scene", plain), ("pages", "pages", plain),
                   ("KB of all pages", "all_page_bytes", kilobytes), ("KB until 95 %", "bytes_95", fixed_kilobytes),
                   ("99 %", "bytes_99", fixed_kilobytes), ("99.9 %", "bytes_99_9", fixed_kilobytes), ("100 %", "bytes_100", fixed_kilobytes))


def best_whole_files():
    """By scene: of files with at most 0.1 % of wrong pixels the smallest one; the .glb is one."""
    best = {}
    for row in rows_of("whole_files"):
        right = row["wrong_percent"] and float(row["wrong_percent"]) <= 0.1
        if right and (row["scene"] not in best or int(row["smallest_bytes"]) < int(best[row["scene"]]["smallest_bytes"])):
            best[row["scene"]] = row
    return best


def whole_files():
    """A row per scene: the raw file and the best one, each at its best compression."""
    table = [["scene", ".glb, KB", "compressed", "smallest right file", "KB", "wrong pixels, %", "s at 10", "25", "50", "100 Mbit/s",
              "smallest file", "KB", "wrong pixels, %"]]
    for scene, best in best_whole_files().items():
        rows = rows_of("whole_files", scene=scene)
        raw = [row for row in rows if row["method"] == "as it is"]  # one or none
        least = min(rows, key=lambda row: int(row["smallest_bytes"]))
        table.append([scene, *(kilobytes(raw[0][key]) if raw else "" for key in ("as_it_is_bytes", "smallest_bytes")),
                      f"{best['method']}, {best['smallest']}", kilobytes(best["smallest_bytes"]), fixed(3)(best["wrong_percent"]),
                      *(fixed(2)(best[f"seconds_{rate}"]) for rate in (10, 25, 50, 100)), f"{least['method']}, {least['smallest']}",
                      kilobytes(least["smallest_bytes"]), fixed(2)(least["wrong_percent"]) if least["wrong_percent"] else ""])
    return table


def whole_files_streamed():
    """Times sooner: the seconds of the best whole file over ours."""
    best, table = best_whole_files(), [["scene", "pages", "requests", "wrong pixels, %", "KB until 99 %", "99.9 %", "s until 99 % at 10",
                                        "25", "50", "100 Mbit/s", "times sooner at 10", "25", "50", "100", "99.9 % at 10", "100"]]
    for row in rows_of("whole_files_streamed"):
        if (row["pages"], row["requests"]) in (("as they are", "6"), ("gzip", "6"), ("gzip", "in order")):
            def sooner(level, rate, row=row):
                return fixed(1)(float(best[row["scene"]][f"seconds_{rate}"]) / float(row[f"seconds_{level}_{rate}"]))
            table.append([row["scene"], row["pages"], row["requests"], fixed(3)(row["wrong_percent"]), kilobytes(row["bytes_99"]),
                          kilobytes(row["bytes_99_9"]), *(fixed(2)(row[f"seconds_99_{rate}"]) for rate in (10, 25, 50, 100)),
                          *(sooner("99", rate) for rate in (10, 25, 50, 100)), sooner("99_9", 10), sooner("99_9", 100)])
    return table


def whole_files_sooner():
    """Seconds of the smallest right file over ours until 99 % of a view."""
    best, table = best_whole_files(), [["scene", "smallest right file, KB", "streamed with gzip, KB", "times sooner at 10", "25", "50", "100 Mbit/s"]]
    for row in rows_of("whole_files_streamed", pages="gzip", requests="6"):
        table.append([row["scene"], kilobytes(best[row["scene"]]["smallest_bytes"]), kilobytes(row["bytes_99"]),
                      *(fixed(1)(float(best[row["scene"]][f"seconds_{rate}"]) / float(row[f"seconds_99_{rate}"])) for rate in (10, 25, 50, 100))])
    return table


def whole_files_container():
    return columns(rows_of("whole_files_container"), ("scene", "scene", plain), ("pages, KB", "pages_bytes", kilobytes),
                   ("cell chunks", "cells_bytes", kilobytes), ("front", "front_bytes", kilobytes), ("gltfpack, 16 bits", "bytes_16", kilobytes),
                   ("bits missing", "missing_bits", plain), ("at our grid", "equal_bytes", kilobytes), ("ours over that", "over_equal", fixed(2)),
                   ("both with gzip", "over_equal_gzip", fixed(2)))


def shadows():
    return columns(rows_of("shadows"), ("scene", "scene", plain), ("cells", "cells", plain), ("views", "views", plain),
                   ("shadowed %", "shadowed_percent", fixed(1)), ("wrong with sets", "wrong_of_sets", scientific),
                   ("with casters", "wrong", scientific), ("standard error", "standard_error", scientific),
                   ("at the point", "wrong_at_point", scientific), ("worst view", "worst_view", scientific),
                   ("polygons in the boxes", "culled_polygons", grouped), ("drawn with sets, %", "drawn_of_sets_percent", fixed(1)),
                   ("with casters, %", "drawn_percent", fixed(1)))


def casters():
    table = [["scene", "cells", "CPU s without", "with", "times", "bytes without", "with", "times", "casters per cell", "drawn with sets, %",
              "with casters, %", "rays", "wrong with sets", "with casters", "upper bound"]]
    for row in rows_of("casters"):
        cpu, size = (float(row[name]) / float(row[name + "_of_sets"]) for name in ("cpu_seconds", "bytes"))
        table.append([row["scene"], row["cells"], fixed(1)(row["cpu_seconds_of_sets"]), fixed(1)(row["cpu_seconds"]), fixed(2)(cpu),
                      grouped(row["bytes_of_sets"]), grouped(row["bytes"]), fixed(2)(size), grouped(row["casters_per_cell"]),
                      fixed(2)(row["set_percent"]), fixed(2)(row["drawn_percent"]), grouped(row["rays"]), grouped(row["misses_of_sets"]),
                      row["misses"], scientific(row["upper_bound"])])
    return table


def lamps():
    """Sums over the lamps of a kind."""
    table = [["lamps", "number", "polygons in a set: median", "most", "found by rays", "of these not in the set", "missed",
              "lamps with a miss", "rays that miss"]]
    for kind in ("point", "spot"):
        rows = rows_of("lamps", kind=kind)

        def total(key):
            return sum(int(row[key]) for row in rows)

        sizes = [int(row["in_set"]) for row in rows]
        table.append([kind, str(len(rows)), grouped(statistics.median(sizes)), grouped(max(sizes)), grouped(total("found")),
                      grouped(total("not_in_set")), grouped(total("missed")), str(sum(row["missed"] != "0" for row in rows)),
                      f"{total('misses'):,} of {total('rays'):,}"])
    return table


def lamps_cells():
    return columns(rows_of("lamps_cells"), ("scene", "scene", plain), ("cell", "cell", plain), ("rays", "rays", grouped),
                   ("lamps that touch it", "lamps_touching", plain), ("that rays find", "lamps_found", plain), ("missed", "missed", plain),
                   ("lit points", "lit_points", grouped), ("of a missed lamp", "lit_points_missed", plain))


def lamps_cost():
    return columns(rows_of("lamps_cost"), ("scene", "scene", plain), ("quality", "quality", plain), ("lamps", "lamps", plain),
                   ("cells", "cells", plain), ("CPU s without", "cpu_seconds_without", fixed(1)), ("with", "cpu_seconds_with", fixed(1)),
                   ("per lamp", "cpu_seconds_per_lamp", fixed(2)), ("M rays per lamp", "million_rays_per_lamp", fixed(2)),
                   ("bytes per lamp", "bytes_per_lamp", grouped), ("polygons per lamp", "polygons_per_lamp", grouped),
                   ("lamps that touch a cell", "lamps_per_cell", fixed(1)), ("largest bound", "max_upper_bound", scientific),
                   ("verify: rays", "verify_rays", grouped), ("misses", "verify_misses", plain))


def level_flight():
    return columns(rows_of("level_flight"), ("scene", "scene", plain), ("coverages", "coverages", plain), ("objects", "objects", grouped),
                   ("that switch", "objects_that_switch", plain), ("switches", "switches", plain), ("frames", "frames", plain),
                   ("pixels at coarser levels, %", "at_levels_percent", fixed(1)), ("missed", "missed", scientific),
                   ("worst frame", "worst_frame", scientific), ("missed pixels", "missed_pixels", plain),
                   ("without levels too", "of_set", plain), ("in gaps", "in_gaps", plain), ("inside polygons", "inside_polygons", plain),
                   ("side by side", "beside_misses", plain))


def kills():
    """All kills together."""
    table, kinds = [["event", "times", "cells reported", "cells lost", "wrong files"]], {}
    for row in rows_of("kills"):
        kinds.setdefault("SIGKILL" if row["event"].startswith("SIGKILL") else row["event"], []).append(row)
    for kind, rows in kinds.items():
        table.append([kind, *(f"{sum(int(row[key] or 0) for row in rows):,}" for key in ("times", "cells_reported", "cells_lost", "wrong"))])
    return table


def malformed():
    outcomes = {}
    for row in rows_of("malformed"):
        outcomes[row["outcome"]] = outcomes.get(row["outcome"], 0) + 1
    found = sorted(outcomes.items(), key=lambda outcome: -outcome[1])
    return [[name for name, _ in found], [str(count) for _, count in found]]


def threads():
    return columns(rows_of("threads", options=""), ("scene", "scene", plain), ("CPU s, 1 thread", "cpu_seconds_1", fixed(1)), ("2 threads", "cpu_seconds_2", fixed(1)),
                   ("in parallel sections, %", "parallel_percent", fixed(1)))


def growth():
    return columns(rows_of("growth"), ("scene", "scene", plain), ("cells", "cells_stored", grouped), ("CPU s", "cpu_seconds", fixed(1)),
                   ("peak memory, MiB", "peak_mib", grouped))


def markdown(table):
    lines = ["| " + " | ".join(row) + " |" for row in table]
    return "\n".join([lines[0], "|" + "---|" * len(table[0]), *lines[1:]])


def source(name):
    facts, _ = result_files.read(os.path.join(result_files.FOLDER, name + ".csv"))
    machine = "" if facts["machine"] == USUAL_MACHINE else f", {facts['machine']}"
    return f"`{facts['command']}`, commit {facts['commit']}{machine}."


def page(template):
    out = []
    with open(os.path.join(result_files.FOLDER, template), encoding="utf-8") as stream:
        for line in stream.read().splitlines():
            kind, _, name = line.partition(" ")
            if kind == "@table":
                out.append(markdown(globals()[name]()))
            elif kind == "@source":
                out.append(source(name))
            else:
                out.append(line)
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    different = 0
    for template, name in PAGES.items():
        wanted, path = page(template), os.path.join(result_files.ROOT, name)
        if not options.check:
            with open(path, "w", encoding="utf-8") as stream:
                stream.write(wanted)
            continue
        with open(path, encoding="utf-8") as stream:
            found = stream.read()
        sys.stdout.writelines(difflib.unified_diff(found.splitlines(True), wanted.splitlines(True), name, "generated"))
        if found != wanted:
            print(f"{name} differs; write it again: tests/bench/make_benchmarks.py")
            different = 1
    return different


if __name__ == "__main__":
    sys.exit(main())
