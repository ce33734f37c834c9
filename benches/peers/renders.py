"""Whole pictures beside Mitsuba 3: the same scenes, depth, roulette and samples a pixel, in turns.

    python benches/peers/renders.py --dapple target/release/dapple

The time is that of the render alone: no loading, no building, no compiling. The noise is the
variance among pictures of different seeds, relative to the squared mean of each pixel. Efficiency
is 1 / (variance x seconds); ratios are dapple's figure over Mitsuba's.
"""

import argparse
import itertools
import math
import statistics
import textwrap
import time

import numpy as np
import OpenEXR

import common
import gltf

DEPTH, ROULETTE = 20, 5


def names():
    """Scenes that are compared: of the project's own, all that both render alike."""
    own = sorted(path.stem for path in (common.ROOT / "scenes").glob("*.gltf"))
    return [*own, *common.GENERATED, "kitchen (diffuse)"]


def prepared(args, name):
    """A copy of a scene that both can render."""
    stem = name.removesuffix(" (diffuse)")
    source = common.ROOT / "scenes" / f"{stem}.gltf"
    if stem in common.GENERATED:
        source = common.generated(args.dapple, stem, args.work)
    target = args.work / "common" / f"{name.replace(' ', '_')}.glb"
    gltf.common_copy(source, target, diffuse=name != stem)
    return target, gltf.Scene(target)


class Mitsuba:
    """A scene in Mitsuba, compiled."""

    def __init__(self, args, scene, width, height):
        import mitsuba as mi

        self.mi, self.spp = mi, args.spp
        self.scene = gltf.to_mitsuba(scene, width, height, DEPTH, ROULETTE, args.mitsuba_sampler)
        self.render(0)

    def render(self, seed):
        """Seconds and a picture."""
        start = time.perf_counter()
        picture = np.array(self.mi.render(self.scene, spp=self.spp, seed=seed))
        return time.perf_counter() - start, picture[..., :3].astype(float)


class Dapple:
    """The same in dapple."""

    def __init__(self, args, path, width, height):
        self.args, self.path, self.size = args, path, f"{width}x{height}"

    def render(self, seed):
        """Seconds and a picture."""
        out = self.args.work / "dapple.exr"
        told = common.dapple(
            self.args.dapple, "render", self.path, "-o", out, "--resolution", self.size,
            "--spp", self.args.spp, "--seed", seed, "--max-depth", DEPTH, "--rr-depth", ROULETTE,
            "--filter", "box", "--bsdf", "appendix-b", "--threads", self.args.threads,
            "--sampler", self.args.sampler, "--progress", "none", "--json")
        channels = OpenEXR.File(str(out), separate_channels=True).channels()
        picture = np.stack([channels[channel].pixels for channel in "RGB"], -1)
        return told["render_s"], picture.astype(float)


def compare(args, name):
    """The figures of a scene."""
    path, scene = prepared(args, name)
    height = args.height
    width = round(height * scene.camera[0].get("aspectRatio", 1))
    both = Mitsuba(args, scene, width, height), Dapple(args, path, width, height)
    turns = [[one.render(seed) for one in both] for seed in range(1, args.rounds + 1)]
    pictures = np.array([[picture for _, picture in turn] for turn in turns])
    variance = pictures.var(axis=0, ddof=1)
    mean = pictures.mean(axis=(0, 1))
    scale = mean**2 + 0.01 * mean.mean() ** 2
    means = pictures.mean(axis=(0, 2, 3, 4))
    errors = np.sqrt(variance.sum(axis=(1, 2, 3)) / args.rounds) / mean.size / means
    seconds = [statistics.median(turn[i][0] for turn in turns) for i in (0, 1)]
    noise = [float((variance[i] / scale).mean()) for i in (0, 1)]
    return {
        "scene": name, "triangles": len(scene.triangles()), "width": width, "height": height,
        "mitsuba_s": seconds[0], "dapple_s": seconds[1],
        "mitsuba_variance": noise[0], "dapple_variance": noise[1],
        "speed": seconds[0] / seconds[1],
        "speeds": [turn[0][0] / turn[1][0] for turn in turns],
        "efficiency": seconds[0] * noise[0] / (seconds[1] * noise[1]),
        "means": means[1] / means[0], "means_error": float(np.hypot(*errors) * means[1] / means[0]),
    }


def tables(found):
    """The figures as Markdown."""
    heading = ["scene", "triangles", "Mitsuba s", "dapple s", "Mitsuba variance",
               "dapple variance", "speed", "efficiency", "means"]
    rows = [[row["scene"], f"{row['triangles']:,}", f"{row['mitsuba_s']:.2f}",
             f"{row['dapple_s']:.2f}", f"{row['mitsuba_variance']:.4f}",
             f"{row['dapple_variance']:.4f}", f"{row['speed']:.2f}", f"{row['efficiency']:.2f}",
             f"{row['means']:.4f} ± {row['means_error']:.4f}"] for row in found["rows"]]
    lines = common.table(heading, rows)
    values = {key: [row[key] for row in found["rows"]] for key in ("speed", "efficiency")}
    middle = {key: math.exp(statistics.fmean(map(math.log, value)))
              for key, value in values.items()}
    for key, words in [("speed", "Speed"), ("efficiency", "Efficiency")]:
        lines += ["", f"{words}: {common.span(values[key])} times Mitsuba's, "
                      f"geometric mean {middle[key]:.2f}."]
    reasons = itertools.groupby(sorted(found["left_out"], key=lambda row: row[1]),
                                key=lambda row: row[1])
    lines += ["", "Left out:", ""]
    for reason, group in reasons:
        text = f"- {', '.join(f'`{name}`' for name, _ in group)}: {reason}"
        lines += textwrap.wrap(text, 100, subsequent_indent="  ", break_on_hyphens=False)
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    common.arguments(parser)
    common.json_argument(parser)
    parser.add_argument("--height", type=int, default=256, help="of the pictures, in pixels")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--threads", type=int, default=1, help="of both")
    parser.add_argument("--sampler", default="lattice", help="dapple's")
    parser.add_argument("--mitsuba-sampler", default="multijitter")
    args = parser.parse_args()
    if args.rounds < 2:
        parser.error("noise needs two rounds or more")

    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    dr.set_thread_count(args.threads)
    rows, left_out = [], []
    for name in common.wanted(names(), args.only):
        try:
            rows.append(compare(args, name))
        except gltf.LeftOut as reason:
            left_out.append((name, str(reason)))
    settings = {key: getattr(args, key) for key in
                ("rounds", "height", "spp", "threads", "sampler", "mitsuba_sampler")}
    packages = ["mitsuba", "drjit", "numpy"]
    found = common.conditions(args.dapple, packages, depth=DEPTH, roulette=ROULETTE, **settings)
    llvm = ".".join(map(str, dr.detail.llvm_version()))
    found |= {"llvm": llvm, "rows": rows, "left_out": left_out}
    common.finish(found, args.json, tables(found))


if __name__ == "__main__":
    main()
