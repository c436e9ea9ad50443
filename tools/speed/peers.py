#!/usr/bin/env python3
"""The same files through f3d, through Open CASCADE and Embree, and through trimray, side by side.

    pip install f3d cadquery-ocp embreex numpy pillow
    peers.py --bin target/release/trimray [--share 1e-3] [--json OUT] FILE|FOLDER...

For each file and each of the three: seconds from the file to a picture of 1024 by 1024 pixels, a process of its own from start to end, and its peak of memory;
millions of first hits a second on one thread, with the share of the rays that hit; how far hits are off, 99.9 % of them, in diagonals of the model, against
`trimray probe --precision f64`; and the size of what is traced, mesh and tree of the one, the mapped scene of the other.

f3d draws triangles, and has no rays to count. Open CASCADE meshes with a chord error of `--share` of the diagonal, and Embree traces the mesh through embreex,
in float32 and without the anti-aliasing and ambient occlusion that trimray's picture has. Both find the first hits of the same rays, those of that picture from
row to row, in which the model's box just fits (`trimray bench rays`); of several runs the fastest counts.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parent.parent / "rival")]
from compare_pictures import F3D, files, run

SIDE = 1024
COMPARED = 20_000
RUNS = 5


def grid(corners):
    """Rays of an orthographic picture from above at an angle, (n, 3) each, and the model's diagonal."""
    import itertools

    import numpy as np

    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    diagonal = float(np.linalg.norm(high - low))
    forward = np.array([1.0, 1.0, -0.8]) / np.linalg.norm([1.0, 1.0, -0.8])
    right = np.array([1.0, -1.0, 0.0]) / np.sqrt(2)
    up = np.cross(right, forward)
    box = np.array(list(itertools.product(*zip(low - (low + high) / 2, high - (low + high) / 2))))
    widest = 2 * max(np.abs(box @ right).max(), np.abs(box @ up).max())
    steps = ((np.arange(SIDE) + 0.5) / SIDE - 0.5) * widest
    x, y = np.meshgrid(steps, -steps)
    origins = (low + high) / 2 - forward * diagonal + x[..., None] * right + y[..., None] * up
    return origins.reshape(-1, 3), np.broadcast_to(forward, (SIDE * SIDE, 3)), diagonal


def embree_picture(path, share, picture, binary):
    """Meshes, traces and writes a picture; with trimray's `binary` says what it measured on the way, and how far hits are off."""
    import mesh_embree
    import numpy as np
    from PIL import Image

    shape = mesh_embree.read(path)
    low_high = mesh_embree.triangles(shape, 1e3)
    origins, directions, diagonal = grid(low_high)
    corners = mesh_embree.triangles(shape, share * diagonal).astype(np.float32)
    # The run without trimray is the one that is timed: nothing is measured on the way.
    scene, _, size = mesh_embree.built_and_sized(corners) if binary else (*mesh_embree.built(corners), None)
    rays = [np.ascontiguousarray(a, dtype=np.float32) for a in (origins, directions)]
    hit, traced = scene.run(*rays), math.inf
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    light = np.where(hit < 0, 1.0, np.abs(normals[hit] @ directions[0]))
    Image.fromarray((light.reshape(SIDE, SIDE) * 255).astype(np.uint8)).save(picture)
    if not binary:
        return
    for _ in range(RUNS):
        clock = time.perf_counter()
        scene.run(*rays, query="DISTANCE")
        traced = min(traced, time.perf_counter() - clock)
    some = np.linspace(0, SIDE * SIDE - 1, COMPARED).astype(int)
    met = mesh_embree.distances(scene, *rays)[some]
    truth, own = (mesh_embree.first_hits(binary, path, origins[some], directions[some], precision) for precision in ("f64", "f32"))
    off = [mesh_embree.quantile(mesh_embree.errors(found, truth, diagonal), 0.999) for found in (met, own)]
    own_seconds = trimray_seconds(binary, path, origins, directions)
    told = {"triangles": len(corners), "rays": SIDE * SIDE, "hits": int(np.sum(hit >= 0)), "seconds": [traced, own_seconds]}
    print(json.dumps({**told, "errors": off, "bytes": [size, baked_bytes(binary, path)]}))


def trimray_seconds(binary, path, origins, directions):
    """Of one thread, for the first hits of the rays."""
    import numpy as np

    with tempfile.NamedTemporaryFile("w", suffix=".txt") as rays:
        np.savetxt(rays, np.hstack([origins, directions]), fmt="%.17g")
        rays.flush()
        command = [binary, "bench", "rays", path, "--rays", rays.name, "--threads", "1", "--repeat", str(RUNS), "--json"]
        return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)["seconds"]


def baked_bytes(binary, path):
    """Of the scene that trimray maps."""
    with tempfile.TemporaryDirectory() as folder:
        baked = Path(folder) / "scene.trimray"
        subprocess.run([binary, "bake", "-q", path, "-o", baked], check=True, capture_output=True)
        return baked.stat().st_size


def compare(arguments, path, folder):
    """A row of numbers; a text where one of the three fails. Nothing large is imported here: a process begins with the peak of the one that starts it."""
    picture, script = f"{folder}/a.png", f"{folder}/one_picture.py"
    Path(script).write_text(F3D)
    embree = [sys.executable, __file__, "--one-picture", picture, "--share", str(arguments.share), str(path)]
    row = {"file": str(path)}
    for name, command in {
        "f3d": [sys.executable, script, str(path), picture, "plain"],
        "embree": embree,
        "trimray": [arguments.bin, "render", "-q", "--device", "cpu", "--no-cache", "--resolution", f"{SIDE},{SIDE}", str(path), "-o", picture],
    }.items():
        result = run(command, arguments.limit)
        if isinstance(result, str):
            return f"{name}: {result}"
        row[name] = {"seconds": result[0], "megabytes": result[1]}
    told = json.loads(subprocess.run([*embree, "--bin", arguments.bin], capture_output=True, text=True, check=True).stdout.splitlines()[-1])
    rates = [told["rays"] / seconds / 1e6 for seconds in told["seconds"]]
    row["embree"].update(triangles=told["triangles"], mrays=rates[0], error=told["errors"][0], bytes=told["bytes"][0])
    row["trimray"].update(mrays=rates[1], error=told["errors"][1], bytes=told["bytes"][1])
    row["hits"] = told["hits"] / told["rays"]
    return row


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", help="trimray")
    parser.add_argument("--share", type=float, default=1e-3, help="chord error of the mesh, in diagonals")
    parser.add_argument("--json", help="rows, one object a line")
    parser.add_argument("--limit", type=float, default=300.0, help="seconds for one picture")
    parser.add_argument("--one-picture", help=argparse.SUPPRESS)
    parser.add_argument("paths", nargs="+", type=Path)
    arguments = parser.parse_args()
    if arguments.one_picture:
        embree_picture(str(arguments.paths[0]), arguments.share, arguments.one_picture, arguments.bin)
        return 0
    if not arguments.bin:
        parser.error("--bin says which trimray")
    rows = []
    print(f"{'f3d':>14}{'Open CASCADE + Embree':>41}{'trimray':>41}")
    print(f"{'s':>8}{'MB':>6}" + 2 * f"{'s':>8}{'MB':>6}{'Mrays/s':>9}{'error':>9}{'scene MB':>9}" + f"{'triangles':>11}{'hit':>6}")
    with tempfile.TemporaryDirectory() as folder:
        for path in files(arguments.paths):
            row = compare(arguments, path, folder)
            if isinstance(row, str):
                print(f"left out: {row}  {path.name}")
                continue
            rows.append(row)
            numbers = f"{row['f3d']['seconds']:8.2f}{row['f3d']['megabytes']:6.0f}"
            for peer in ("embree", "trimray"):
                one = row[peer]
                numbers += f"{one['seconds']:8.2f}{one['megabytes']:6.0f}{one['mrays']:9.2f}{one['error']:9.1e}{one['bytes'] / 1e6:9.2f}"
            print(f"{numbers}{row['embree']['triangles']:11}{row['hits']:6.2f}  {path.name}", flush=True)
    if arguments.json:
        Path(arguments.json).write_text("".join(json.dumps(row) + "\n" for row in rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
