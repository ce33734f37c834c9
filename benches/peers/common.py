"""What the scripts here share: running dapple, the scenes, the machine, and tables."""

import importlib.metadata
import json
import os
import pathlib
import platform
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Made by `dapple generate`, with so many triangles.
GENERATED = {"kitchen": 103_000, "city": 9_200, "assembly": 300_000, "landscape": 644_000}


def arguments(parser):
    """Adds the options of every script."""
    parser.add_argument("--dapple", type=pathlib.Path, default=ROOT / "target/release/dapple")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out/peers",
                        help="a folder for scenes, rays and pictures")
    parser.add_argument("--rounds", type=int, default=5, help="how often both take their turn")
    parser.add_argument("--only", default="", help="scenes by name, separated by commas")


def json_argument(parser):
    """Adds the option of the scripts that measure."""
    parser.add_argument("--json", type=pathlib.Path, help="where to write all figures")


def dapple(binary, *words):
    """Runs dapple and returns the last JSON object that it prints."""
    command = [str(word) for word in (binary, *words)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    lines = done.stdout.strip().splitlines()
    return json.loads(lines[-1]) if lines else None


def generated(binary, name, work):
    """The file of a generated scene, made if it is not there."""
    path = work / f"{name}.glb"
    if not path.exists():
        work.mkdir(parents=True, exist_ok=True)
        dapple(binary, "generate", name, "--triangles", GENERATED[name], "-o", path, "--quiet")
    return path


def wanted(names, only):
    """Those of `names` that `only` names, or all of them."""
    chosen = [name for name in only.split(",") if name]
    return [name for name in names if not chosen or name in chosen]


def processor():
    """The name of the CPU and the widest vectors that it has."""
    name, flags = platform.processor() or "unknown", ""
    if os.path.exists("/proc/cpuinfo"):
        for line in open("/proc/cpuinfo"):
            key, _, value = line.partition(":")
            if key.strip() == "model name":
                name = value.strip()
            elif key.strip() == "flags":
                flags = value.split()
    widest = next((isa for isa in ("avx512f", "avx2", "sse4_2") if isa in flags), "")
    return f"{name} ({ {'avx512f': 'AVX-512', 'avx2': 'AVX2'}.get(widest, widest) })"


def conditions(binary, packages, **settings):
    """What a reader must know to judge the figures."""
    told = subprocess.run([binary, "--version"], capture_output=True, text=True, check=True)
    versions = {name: importlib.metadata.version(name) for name in packages}
    versions["dapple"] = told.stdout.split()[-1]
    versions["python"] = platform.python_version()
    return {"processor": processor(), "versions": versions, "settings": settings}


def table(heading, rows):
    """Lines of Markdown: the first column to the left, all others to the right."""
    lines = [heading, ["---", *["---:"] * (len(heading) - 1)], *rows]
    return ["| " + " | ".join(map(str, line)) + " |" for line in lines]


def span(values, digits=2):
    """The least and the greatest."""
    return f"{min(values):.{digits}f} to {max(values):.{digits}f}"


def finish(found, path, lines):
    """Writes the figures and prints the tables."""
    if path:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(found, indent=1) + "\n")
    print("\n".join(lines))
