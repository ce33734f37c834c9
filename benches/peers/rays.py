"""Rays beside Embree 4: the same triangles, the same rays, one thread, in turns.

    python benches/peers/rays.py --dapple target/release/dapple

Rates are those from rays to hits, both in memory, after an untimed pass. Embree answers one ray a
call, and sixteen a call; dapple answers slices, and ray by ray. Primary rays come in the order that
suits each: Embree gets tiles of four by four pixels, dapple's slices are rows of a raster whose
width is told. Ratios are dapple's rate over Embree's, the median of all rounds.
"""

import argparse
import statistics
import time

import numpy as np

import common
import embree
import gltf

SETS = [(rays, query) for rays in ("random", "bounce", "primary") for query in ("closest", "any")]
PAIRS = [("slices", "embree_1"), ("slices", "embree_16"), ("single", "embree_1")]


def prepared(args, name):
    """The triangles of a scene, and its camera."""
    source = common.ROOT / "scenes" / f"{name}.gltf"
    if name in common.GENERATED:
        source = common.generated(args.dapple, name, args.work)
    target = args.work / "common" / f"{name}.glb"
    gltf.common_copy(source, target)
    scene = gltf.Scene(target)
    return scene.triangles(), scene.camera


def packed(origins, directions):
    """Rays without an end."""
    rays = np.zeros((len(origins), 8), np.float32)
    rays[:, :3], rays[:, 4:7], rays[:, 7] = origins, directions, np.inf
    return rays


def unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-20)


def random_rays(triangles, count, rng):
    """From a point in the scene's box towards another."""
    corners = triangles.reshape(-1, 3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    ends = rng.uniform(low, high, (2, count, 3))
    return packed(ends[0], unit(ends[1] - ends[0]))


def primary_rays(camera, count):
    """Through the centres of a raster's pixels, row by row; and the width of that."""
    lens, matrix = camera
    aspect = lens.get("aspectRatio", 1)
    height = int((count / aspect) ** 0.5) // 4 * 4
    width = int(height * aspect) // 4 * 4
    rows, columns = np.mgrid[0:height, 0:width]
    slope = np.tan(lens["yfov"] / 2)
    x = ((columns.ravel() + 0.5) / width * 2 - 1) * slope * aspect
    y = (1 - (rows.ravel() + 0.5) / height * 2) * slope
    directions = np.stack([x, y, -np.ones_like(x)], -1) @ matrix[:3, :3].T
    origins = np.broadcast_to(matrix[:3, 3], directions.shape)
    return packed(origins, unit(directions)), width


def in_tiles(rays, width):
    """A raster's rays by tiles of four by four."""
    tiles = rays.reshape(-1, 4, width // 4, 4, 8)
    return np.ascontiguousarray(tiles.transpose(0, 2, 1, 3, 4)).reshape(-1, 8)


def bounce_rays(scene, triangles, rays, rng):
    """From what random rays hit, by the cosine, as the later segments of paths are."""
    hits = embree.room_for_hits(len(rays), True)
    scene.shoot(rays, hits)
    hit = np.isfinite(hits[:, 0])
    rays, distance = rays[hit].astype(float), hits[hit, :1]
    corners = triangles[hits[hit, 3].view(np.uint32)].reshape(-1, 3, 3).astype(float)
    normals = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    normals *= -np.sign((normals * rays[:, 4:7]).sum(-1, keepdims=True))
    size = np.ptp(triangles.reshape(-1, 3), axis=0).max()
    origins = rays[:, :3] + distance * rays[:, 4:7] + 1e-5 * size * normals
    return packed(origins, unit(normals + unit(rng.normal(size=normals.shape))))


def embree_rate(scene, rays, query, lanes, passes):
    """Millions of rays a second, and how many hit."""
    hits = embree.room_for_hits(len(rays), query == "closest")
    scene.shoot(rays, hits, lanes)
    seconds = []
    for _ in range(passes):
        start = time.perf_counter()
        scene.shoot(rays, hits, lanes)
        seconds.append(time.perf_counter() - start)
    return len(rays) / statistics.median(seconds) * 1e-6, embree.hit_count(hits)


def dapple_rate(args, files, query, flags):
    """The same of dapple."""
    flags = ["--any"] * (query == "any") + flags
    told = common.dapple(args.dapple, "trace", files[0], "--rays", files[1], *flags, "--threads", 1,
                         "--accel", args.accel, "--repeat", args.passes, "--json")
    return told["mrays_s"], told["hits"]


def compare(args, name):
    """The figures of a scene, a row per set of rays and query."""
    triangles, camera = prepared(args, name)
    rng = np.random.default_rng(1)
    scene = embree.Scene(triangles)
    sets = {"random": random_rays(triangles, args.rays, rng)}
    sets["bounce"] = bounce_rays(scene, triangles, sets["random"], rng)
    sets["primary"], width = primary_rays(camera, args.rays)
    triangle_file = args.work / "triangles.npy"
    np.save(triangle_file, triangles)
    rows = []
    for kind, query in SETS:
        ray_file = args.work / "rays.npy"
        np.save(ray_file, sets[kind])
        files = triangle_file, ray_file
        primary = kind == "primary"
        theirs = in_tiles(sets[kind], width) if primary else sets[kind]
        raster = ["--width", width] if primary else []
        ways = {
            "embree_1": lambda: embree_rate(scene, theirs, query, 1, args.passes),
            "slices": lambda: dapple_rate(args, files, query, raster),
            "embree_16": lambda: embree_rate(scene, theirs, query, 16, args.passes),
            "single": lambda: dapple_rate(args, files, query, ["--single"]),
        }
        turns = [{way: run() for way, run in ways.items()} for _ in range(args.rounds)]
        row = {"scene": name, "triangles": len(triangles), "rays": kind, "query": query,
               "count": len(sets[kind])}
        row["mrays_s"] = {way: statistics.median(turn[way][0] for turn in turns) for way in ways}
        row["hits"] = {way: turns[0][way][1] for way in ways}
        for ours, peer in PAIRS:
            ratios = [turn[ours][0] / turn[peer][0] for turn in turns]
            row[f"{ours}_over_{peer}"] = {"median": statistics.median(ratios),
                                            "least": min(ratios), "most": max(ratios)}
        rows.append(row)
    return rows


def ratio(row, pair):
    """How many times as fast dapple is."""
    return row[f"{pair[0]}_over_{pair[1]}"]["median"]


def tables(found):
    """The figures as Markdown: ranges over scenes, then all of them."""
    heading = ["rays", "query", "slices / Embree 1", "slices / Embree 16", "ray by ray / Embree 1"]
    rows = []
    for kind, query in SETS:
        chosen = [row for row in found["rows"] if (row["rays"], row["query"]) == (kind, query)]
        spans = [common.span([ratio(row, pair) for row in chosen]) for pair in PAIRS]
        rows.append([kind, query, *spans])
    lines = common.table(heading, rows)
    heading = ["scene", "triangles", "rays", "query", "Embree 1", "Embree 16", "slices",
               "ray by ray", "slices / Embree 1", "slices / Embree 16", "ray by ray / Embree 1"]
    rows = []
    for row in found["rows"]:
        rates = [f"{row['mrays_s'][way]:.2f}"
                 for way in ("embree_1", "embree_16", "slices", "single")]
        ratios = [f"{ratio(row, pair):.2f}" for pair in PAIRS]
        rows.append([row["scene"], f"{row['triangles']:,}", row["rays"], row["query"],
                     *rates, *ratios])
    hits = {way: sum(row["hits"][way] for row in found["rows"])
            for way in ("slices", "embree_1", "embree_16")}
    lines += ["", f"Rays that hit: {hits['slices']:,} by dapple, {hits['embree_1']:,} by Embree "
                  f"ray by ray, {hits['embree_16']:,} by sixteen."]
    return [*lines, "", "Each scene, in millions of rays a second:", "",
            *common.table(heading, rows)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    common.arguments(parser)
    common.json_argument(parser)
    parser.add_argument("--rays", type=int, default=500_000, help="of each set, at most")
    parser.add_argument("--passes", type=int, default=3, help="timed passes of a turn")
    parser.add_argument("--accel", default="auto", help="dapple's structure")
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    rows = []
    for name in common.wanted(["cornell", *common.GENERATED], args.only):
        rows += compare(args, name)
    settings = {key: getattr(args, key) for key in ("rounds", "rays", "passes", "accel")}
    found = common.conditions(args.dapple, ["embreex", "numba", "numpy"], threads=1, **settings)
    found["rows"] = rows
    common.finish(found, args.json, tables(found))


if __name__ == "__main__":
    main()
