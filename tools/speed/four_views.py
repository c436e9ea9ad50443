#!/usr/bin/env python3
"""Four views with lines in one command, against the bake and the same four views one by one from what it baked.

    four_views.py --bin target/release/trimray [--device cpu|gpu] [--runs 3] [--edges feature] FILE...

Every command is a process of its own, from start to end; one run is the one command, the bake, and the four single views, in turn, so that what else
the machine does falls on all of them. Printed are least and median seconds of each, and how many times the bake and the four views the one command takes.
"""

import argparse
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

VIEWS = ("iso", "front", "top", "right")


def seconds(command: list[str]) -> float:
    start = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - start


def measure(arguments, file: Path, folder: Path) -> tuple[list[float], list[float], list[float]]:
    """Times of the one command, the bakes, and the four single views together."""
    baked = folder / "scene.trimray"
    flags = ["--edges", arguments.edges, "--device", arguments.device, "--resolution", "1024,1024"]
    render = [arguments.bin, "render", *flags]
    together, bakes, apart = [], [], []
    for _ in range(arguments.runs):
        at_once = [*render, str(file), "--no-cache", "--view", ",".join(VIEWS), "-o", str(folder / "{view}.png")]
        together.append(seconds(at_once))
        bakes.append(seconds([arguments.bin, "bake", "--edges", str(file), "-o", str(baked)]))
        single = lambda view: [*render, str(baked), "--view", view, "-o", str(folder / f"single-{view}.png")]
        apart.append(sum(seconds(single(view)) for view in VIEWS))
        for view in VIEWS:
            if (folder / f"{view}.png").read_bytes() != (folder / f"single-{view}.png").read_bytes():
                raise SystemExit(f"{file.name}: the pictures of {view} differ")
    return together, bakes, apart


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="target/release/trimray")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--edges", default="feature")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("files", nargs="+", type=Path)
    arguments = parser.parse_args()
    for file in arguments.files:
        with tempfile.TemporaryDirectory() as folder:
            together, bakes, apart = measure(arguments, file, Path(folder))
        names = ("one command", "bake", "four views")
        told = [
            f"{name} {min(times):.2f} ({statistics.median(times):.2f}) s"
            for name, times in zip(names, (together, bakes, apart))
        ]
        ratio = statistics.median(one / (bake + four) for one, bake, four in zip(together, bakes, apart))
        print(f"{file.name}: {', '.join(told)}; ratio {ratio:.2f}", flush=True)


if __name__ == "__main__":
    main()
