#!/usr/bin/env python3
"""Times from a file to a picture of 1024 by 1024 pixels, of trimray and of f3d, in the same run.

    compare_pictures.py --bin target/release/trimray [--f3d PYTHON] [--json OUT] [--limit 300] FILE|FOLDER...

f3d: its library from PyPI (`pip install f3d`, version 4), headless; PYTHON is an interpreter that has it. Once as the library is without
settings, and once with ambient occlusion and anti-aliasing, which its viewer turns on for CAD files. trimray: `render` as it is without
settings (anti-aliased, ambient occlusion), on the CPU: baked anew (`--no-cache`), and once more with the scene kept
by a run before. Every picture is a process of its own, from start to end; seconds of wall clock, the peak of its memory in MB.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CAD = (".step", ".stp", ".p21", ".iges", ".igs")

F3D = """
import sys, f3d
f3d.Log.set_verbose_level(f3d.Log.QUIET)
f3d.Engine.autoload_plugins()
try:
    engine = f3d.Engine.create_egl()
except Exception:
    engine = f3d.Engine.create_osmesa()
engine.window.size = 1024, 1024
if sys.argv[3] == "full":
    engine.options["render.effect.ambient_occlusion"] = True
    engine.options["render.effect.antialiasing.mode"] = "fxaa"
engine.scene.add(sys.argv[1])
engine.window.render_to_image().save(sys.argv[2])
"""


def run(command: list[str], limit: float):
    """(seconds, peak memory in MB), or why there are none."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        seconds = time.perf_counter() - start
        if pid:
            break
        if seconds > limit:
            process.kill()
            process.wait()
            return f"not within {limit:.0f} s"
        time.sleep(0.002)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        return f"exit code {process.returncode}"
    return seconds, usage.ru_maxrss / 1024


def files(paths: list[Path]):
    for path in paths:
        inside = sorted(path.rglob("*")) if path.is_dir() else [path]
        yield from (p for p in inside if p.suffix.lower() in CAD and p.is_file())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="trimray")
    parser.add_argument("--f3d", default=sys.executable, help="a Python with f3d")
    parser.add_argument("--json", help="rows, one object a line")
    parser.add_argument("--limit", type=float, default=300.0, help="seconds for one picture")
    parser.add_argument("paths", nargs="+", type=Path)
    arguments = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        picture, script, kept = f"{folder}/a.png", f"{folder}/one_picture.py", f"{folder}/kept"
        Path(script).write_text(F3D)
        ours = [arguments.bin, "render", "-q", "--device", "cpu", "--resolution", "1024,1024", "-o", picture]
        print(f"{'f3d':>8}{'MB':>6}{'full':>8}{'trimray':>9}{'MB':>6}{'kept':>8}{'ratio':>8}{'kept':>8}")
        for path in files(arguments.paths):
            commands = {
                "f3d": [arguments.f3d, script, str(path), picture, "plain"],
                "f3d_full": [arguments.f3d, script, str(path), picture, "full"],
                "trimray": [*ours, str(path), "--no-cache"],
                "first": [*ours, str(path), "--cache-dir", kept],
                "kept": [*ours, str(path), "--cache-dir", kept],
            }
            found = {name: run(command, arguments.limit) for name, command in commands.items()}
            rows.append({"file": str(path), **found})
            if isinstance(found["f3d"], str) or isinstance(found["trimray"], str):
                print(f"left out: f3d {found['f3d']}, trimray {found['trimray']}  {path}")
                continue
            (plain, plain_mb), (own, own_mb), (again, _) = found["f3d"], found["trimray"], found["kept"]
            full = found["f3d_full"][0] if not isinstance(found["f3d_full"], str) else float("nan")
            print(f"{plain:8.2f}{plain_mb:6.0f}{full:8.2f}{own:9.2f}{own_mb:6.0f}{again:8.2f}{plain / own:8.1f}{plain / again:8.1f}  {path.name}", flush=True)
    both = [row for row in rows if not isinstance(row["f3d"], str) and not isinstance(row["trimray"], str)]
    if both:
        slower = [row for row in both if row["trimray"][0] > row["f3d"][0]]
        heavier = [row for row in both if row["trimray"][1] > row["f3d"][1]]
        total = {name: sum(row[name][0] for row in both) for name in ("f3d", "trimray", "kept")}
        print(f"{len(both)} files: f3d {total['f3d']:.1f} s, trimray {total['trimray']:.1f} s, kept {total['kept']:.1f} s; "
              f"trimray is slower on {len(slower)}, takes more memory on {len(heavier)}")
    if arguments.json:
        Path(arguments.json).write_text("".join(json.dumps(row) + "\n" for row in rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
