"""Runs both comparisons and rewrites `docs/peers.md`, `docs/results/peers.json` and the README.

    python benches/peers/page.py --dapple target/release/dapple

With `--tables` it runs nothing, and writes the pages anew from the stored figures. With `--check`
it tells whether the pages are those of the stored figures, and exits with 1 if not.
"""

import argparse
import json
import math
import pathlib
import statistics
import subprocess
import sys
import textwrap

import common
import rays
import renders

HERE = pathlib.Path(__file__).parent
RESULTS = common.ROOT / "docs/results/peers.json"


def measured(args):
    """The figures of a new run."""
    args.work.mkdir(parents=True, exist_ok=True)
    found = {}
    shared = ["--dapple", args.dapple, "--work", args.work, "--only", args.only]
    for name, flags in [
        ("rays", ["--rounds", args.rounds, "--rays", args.rays]),
        ("renders", ["--rounds", args.render_rounds, "--height", args.height, "--spp", args.spp]),
    ]:
        target = args.work / f"{name}.json"
        words = [sys.executable, HERE / f"{name}.py", *shared, *flags, "--json", target]
        subprocess.run([str(word) for word in words], check=True)
        found[name] = json.loads(target.read_text())
    return found


def conditions(found):
    """The machine, the versions and the settings, in words."""
    versions = found["rays"]["versions"] | found["renders"]["versions"]
    named = ", ".join(f"{name} {version}" for name, version in sorted(versions.items()))
    shot, drawn = found["rays"]["settings"], found["renders"]["settings"]
    return [
        f"- Processor: {found['rays']['processor']}.",
        *textwrap.wrap(f"- Versions: {named}. LLVM {found['renders']['llvm']}.", 100,
                       subsequent_indent="  "),
        *textwrap.wrap(
            f"- Rays: up to {shot['rays']:,} a set, {shot['rounds']} rounds, one thread, "
            f"`--accel {shot['accel']}`.", 100, subsequent_indent="  "),
        *textwrap.wrap(
            f"- Pictures: {drawn['height']} pixels high, {drawn['spp']} samples a pixel, "
            f"{drawn['rounds']} rounds, threads: {drawn['threads']}. Depth {drawn['depth']}, "
            f"roulette from {drawn['roulette']} on. Samples are placed by {drawn['sampler']} in "
            f"dapple, by {drawn['mitsuba_sampler']} in Mitsuba.", 100, subsequent_indent="  "),
    ]


def claims(found):
    """What the README says, in ranges that hold the worst scene."""
    rows = found["rays"]["rows"]
    incoherent = [row for row in rows if row["rays"] != "primary"]
    primary = [row for row in rows if row["rays"] == "primary"]

    def ranges(chosen, pair):
        return common.span([rays.ratio(row, pair) for row in chosen])

    one, sixteen, single = rays.PAIRS
    triangles = [row["triangles"] for row in rows]
    pictures = [1 / row["efficiency"] for row in found["renders"]["rows"]]
    middle = math.exp(statistics.fmean(map(math.log, pictures)))
    texts = [
        f"Rays, one thread, in {len({row['scene'] for row in rows})} scenes of {min(triangles):,} "
        f"to {max(triangles):,} triangles: dapple's default structure answers slices of incoherent "
        f"rays at {ranges(incoherent, one)} times the rate that Embree 4 reaches ray by ray, and "
        f"primary rays at {ranges(primary, one)} times. Of the rate that Embree reaches with "
        f"sixteen rays a call, that is {ranges(incoherent, sixteen)} and "
        f"{ranges(primary, sixteen)} times. Asked ray by ray as well, dapple reaches "
        f"{ranges(rows, single)} times Embree's rate.",
        f"Whole pictures: at equal noise, dapple takes {common.span(pictures)} times as long as "
        f"Mitsuba 3 with its LLVM backend, in {len(pictures)} scenes, one thread; the geometric "
        f"mean is {middle:.2f}.",
    ]
    return "\n\n".join(textwrap.fill(text, 100) for text in texts).splitlines()


def filled(text, parts):
    """The text with new lines between the marks of each part."""
    for name, lines in parts.items():
        start, end = f"<!-- peers: {name} -->", "<!-- end -->"
        before, after = text.split(start)
        after = after.split(end, 1)[1]
        text = before + "\n".join([start, *lines, end]) + after
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    common.arguments(parser)
    parser.add_argument("--rays", type=int, default=500_000, help="of each set, at most")
    parser.add_argument("--render-rounds", type=int, default=4)
    parser.add_argument("--height", type=int, default=256)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--tables", action="store_true", help="runs nothing")
    parser.add_argument("--check", action="store_true", help="writes nothing")
    args = parser.parse_args()
    stored = args.tables or args.check
    found = json.loads(RESULTS.read_text()) if stored else measured(args)
    parts = {
        "docs/peers.md": {"conditions": conditions(found), "rays": rays.tables(found["rays"]),
                          "pictures": renders.tables(found["renders"])},
        "README.md": {"claims": claims(found)},
    }
    if not stored:
        RESULTS.write_text(json.dumps(found, indent=1) + "\n")
    stale = False
    for name, lines in parts.items():
        page = common.ROOT / name
        text = page.read_text()
        new = filled(text, lines)
        stale |= new != text
        if not args.check:
            page.write_text(new)
        elif new != text:
            print(f"{name} is not that of {RESULTS.name}", file=sys.stderr)
    sys.exit(1 if args.check and stale else 0)


if __name__ == "__main__":
    main()
