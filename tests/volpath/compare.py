#!/usr/bin/env python3
"""Holds the media of dapple against those of Mitsuba 3: three scenes, rendered by both.

    pip install mitsuba numpy
    python3 compare.py target/release/dapple [SCENE.toml...]

Each scene beside this file is rendered by dapple, and by Mitsuba's `volpath` as what the TOML file
says. Both tell the variance of what they found. If both are right, the difference of two sums of
pixels, over its standard deviation, is about normal: z. It is told for the whole picture, for the
worst tile, and as the deviation over all tiles, which is 1 if differences are as large as chance
makes them. Exit code 1 if one of them is beyond its limit.

Python 3.11 or later. What is read of a scene is what the three have.
"""

import argparse
import math
import pathlib
import subprocess
import sys
import tempfile
import time
import tomllib

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)
T = mi.ScalarTransform4f

HERE = pathlib.Path(__file__).resolve().parent
TILE = 8  # pixels a side

# Seeds are fixed, so that a run repeats the last one until either program changes. A new run fails
# by chance about once in 300: the 9 means of three scenes are beyond 4 once in 1,700, and so is one
# of the 576 tiles beyond 5.5 or less, even if rare bright paths make their tails as heavy as those
# of Student's t with 40 degrees of freedom. The deviation over 64 tiles, whose three colours go
# together, is uncertain by 0.09: it is beyond 1.3 once in 800.
WHOLE, WORST, DEVIATION = 4.0, 5.5, 1.3


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("dapple", help="the program")
    parser.add_argument("scenes", nargs="*", type=pathlib.Path, help="[all beside this file]")
    parser.add_argument("--spp", type=int, default=1024, help="samples per pixel, of both [1024]")
    parser.add_argument("--seed", type=int, default=0, help="another number, another noise [0]")
    args = parser.parse_intermixed_args()
    print("| scene | mean over Mitsuba's: R, G, B | its standard error, % | z of the whole |"
          " worst tile | deviation over tiles | s: dapple, Mitsuba |")
    print("|---|---|---|---|---:|---:|---:|")
    bad = []
    for path in args.scenes or sorted(HERE.glob("*.toml")):
        started = time.time()
        ours = by_dapple(args.dapple, path, args.spp, args.seed)
        between = time.time()
        theirs = by_mitsuba(path, args.spp, args.seed)
        ended = time.time()
        row, faults = compare(ours, theirs)
        times = f"{between - started:.0f}, {ended - between:.0f}"
        print(f"| {path.stem} | {row} | {times} |", flush=True)
        bad += [f"{path.stem}: {fault}" for fault in faults]
    sys.exit("\n".join(bad) or 0)


def compare(ours, theirs):
    """A row of the table, and what is beyond its limit, of two pairs of means and variances."""
    (a, variance_a), (b, variance_b) = ours, theirs
    variance = variance_a + variance_b
    # What is seen without chance, such as the sky, has rounding errors alone.
    sure = variance < (1e-5 * b) ** 2
    off = np.abs(a - b) > 1e-4 * b
    difference = np.where(sure & ~off, 0.0, a - b)
    whole = difference.sum((0, 1)) / np.sqrt(variance.sum((0, 1)))
    tiles, spread = by_tile(difference), by_tile(variance)
    tiles = tiles[spread > 0] / np.sqrt(spread[spread > 0])
    worst, deviation = np.abs(tiles).max(), math.sqrt((tiles**2).mean())
    ratio = a.mean((0, 1)) / b.mean((0, 1))
    error = 100 * np.sqrt(variance.sum((0, 1))) / b.sum((0, 1))

    faults = []
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        faults.append("not all pixels are finite")
    if (sure & off).any():
        faults.append(f"{(sure & off).any(-1).sum()} pixels without noise differ")
    if not (np.abs(whole) <= WHOLE).all():
        faults.append(f"the means differ: |z| > {WHOLE}")
    if not worst <= WORST:
        faults.append(f"a tile differs: |z| > {WORST}")
    if not deviation <= DEVIATION:
        faults.append(f"tiles differ more than by chance: their deviation > {DEVIATION}")
    words = [" ".join(f"{value:.{digits}f}" for value in row)
             for row, digits in ((ratio, 4), (error, 2), (whole, 2))]
    return " | ".join([*words, f"{worst:.1f}", f"{deviation:.2f}"]), faults


def by_tile(image):
    height, width, colors = image.shape
    return image.reshape(height // TILE, TILE, width // TILE, TILE, colors).sum((1, 3))


def by_dapple(program, path, spp, seed):
    """Means of the pixels and their variances."""
    with tempfile.TemporaryDirectory() as folder:
        picture = str(pathlib.Path(folder, "picture.exr"))
        command = [program, "render", str(path), "-o", picture, "--aov", "variance"]
        command += ["--spp", str(spp), "--seed", str(seed), "--quiet"]
        subprocess.run(command, check=True)
        image = mi.Bitmap(picture)
        names = [field.name for field in image.struct_()]
        pixels = np.array(image, np.float64)
    layers = [[names.index(prefix + color) for color in "RGB"] for prefix in ("", "variance.")]
    return [pixels[..., layer] for layer in layers]


def by_mitsuba(path, spp, seed, passes=16):
    """Means of the pixels and their variances, by what passes of other seeds differ."""
    scene = mi.load_dict(scene_of(path), parallel=False)
    images = np.array([np.array(mi.render(scene, spp=spp // passes, seed=1000 * seed + number + 1))
                       for number in range(passes)], np.float64)
    return images.mean(0), images.var(0, ddof=1) / passes


def scene_of(path):
    """What a TOML scene says, as Mitsuba is told it."""
    toml = tomllib.loads(path.read_text())
    render, (camera,) = toml["render"], toml["camera"]
    width, height = render["resolution"]
    # Rays begin at the near plane: what mist is before it would be left out.
    sensor = {
        "type": "perspective", "fov_axis": "y", "fov": camera["fov"], "near_clip": 1e-4,
        "to_world": T().look_at(camera["look-from"], camera["look-at"], [0, 1, 0]),
        "sampler": {"type": "independent"},
        "film": {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb",
                 "component_format": "float32", "rfilter": {"type": render["filter"]}},
    }
    # Both count segments alike: 1 sees emitters only, and borders without a BSDF do not count.
    integrator = {"type": "volpath", "max_depth": render["max-depth"], "rr_depth": 50}
    scene = {"type": "scene", "integrator": integrator, "sensor": sensor}
    if "medium" in toml:
        scattering, absorption = (np.broadcast_to(toml["medium"][key], 3).astype(float)
                                  for key in ("scattering", "absorption"))
        extinction = scattering + absorption
        sensor["medium"] = medium(extinction, scattering / extinction, toml["medium"]["anisotropy"])
    if "environment" in toml:
        scene["environment"] = {"type": "constant", "radiance": rgb(toml["environment"]["color"])}
    outside = 1.0  # the index of refraction around the next solid
    for number, place in enumerate(toml["place"]):
        material = place["material"]["*"]
        x, y, z = place.get("rotate", (0, 0, 0))
        to_world = T().translate(place.get("translate", [0, 0, 0])).rotate([0, 0, 1], z)
        to_world = to_world.rotate([0, 1, 0], y).rotate([1, 0, 0], x).scale(place.get("scale", 1))
        scene[f"shape{number}"] = {
            "type": "ply", "filename": str(path.parent / place["file"]), "face_normals": True,
            "to_world": to_world, **surface(material, outside),
        }
        # Solids stand in a scene as they lie within each other: the outer one comes first.
        outside = material["ior"] if material.get("solid") else 1.0
    return scene


def surface(material, outside):
    """A shape's BSDF, emission and inside."""
    parts = {}
    if material.get("solid"):
        glass = {"type": "dielectric", "int_ior": material["ior"], "ext_ior": outside}
        parts["bsdf"] = glass if material["ior"] != outside else {"type": "null"}
    else:
        matt = {"type": "diffuse", "reflectance": rgb(material["base-color"])}
        parts["bsdf"] = {"type": "twosided", "matt": matt}
    if "scatter-albedo" in material:
        left, distance = material["attenuation-color"], material["attenuation-distance"]
        extinction = -np.log(left) / distance
        parts["interior"] = medium(extinction, material["scatter-albedo"],
                                   material["scatter-anisotropy"])
    if "emissive" in material:
        radiance = np.array(material["emissive"]) * material["emissive-strength"]
        parts["emitter"] = {"type": "area", "radiance": rgb(radiance)}
    return parts


def medium(extinction, albedo, anisotropy):
    """`scale` because a colour is to be at most 1."""
    scale = max(extinction)
    return {"type": "homogeneous", "sigma_t": rgb(extinction / scale), "scale": scale,
            "albedo": rgb(albedo), "phase": {"type": "hg", "g": anisotropy}}


def rgb(color):
    return {"type": "rgb", "value": [float(value) for value in color]}


if __name__ == "__main__":
    main()
