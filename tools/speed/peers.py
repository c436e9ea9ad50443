#!/usr/bin/env python3
"""The same files through f3d, through Open CASCADE and Embree, and through trimray, side by side.

    pip install f3d cadquery-ocp embreex numpy pillow
    peers.py --bin target/release/trimray [--share 1e-3] [--json OUT] FILE|FOLDER...

For each file and each of the three: seconds from the file to a picture of 1024 by 1024 pixels, a process of its own from start to end, and its peak of memory;
millions of first hits a second on one thread; and how far hits are off, 99.9 % of them, in diagonals of the model, against `trimray probe --precision f64`.

f3d draws triangles, and has no rays to count. Open CASCADE meshes with a chord error of `--share` of the diagonal, and Embree traces the mesh through embreex,
in float32 and without the anti-aliasing and ambient occlusion that trimray's picture has; its rays are those of that picture. trimray's rays are the primary
ones of `bench stages --frames`, and its error that of f32 on Embree's rays.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parent.parent / "rival")]
from compare_pictures import F3D, files, run

SIDE = 1024
COMPARED = 20_000


def grid(corners):
    """Rays of an orthographic picture from above at an angle, (n, 3) each, and the model's diagonal."""
    import numpy as np

    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    diagonal = float(np.linalg.norm(high - low))
    forward = np.array([1.0, 1.0, -0.8]) / np.linalg.norm([1.0, 1.0, -0.8])
    right = np.array([1.0, -1.0, 0.0]) / np.sqrt(2)
    up = np.cross(right, forward)
    steps = ((np.arange(SIDE) + 0.5) / SIDE - 0.5) * diagonal
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
    scene = mesh_embree.rtcore_scene.EmbreeScene()
    mesh_embree.TriangleMesh(scene, corners)
    rays = [np.ascontiguousarray(a, dtype=np.float32) for a in (origins, directions)]
    scene.run(rays[0][:1], rays[1][:1])
    built = time.perf_counter()
    hit = scene.run(*rays)
    traced = time.perf_counter() - built
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    light = np.where(hit < 0, 1.0, np.abs(normals[hit] @ directions[0]))
    Image.fromarray((light.reshape(SIDE, SIDE) * 255).astype(np.uint8)).save(picture)
    if not binary:
        return
    some = np.linspace(0, SIDE * SIDE - 1, COMPARED).astype(int)
    met = mesh_embree.distances(scene, *rays)[some]
    truth, own = (mesh_embree.first_hits(binary, path, origins[some], directions[some], precision) for precision in ("f64", "f32"))
    off = [mesh_embree.quantile(mesh_embree.errors(found, truth, diagonal), 0.999) for found in (met, own)]
    print(json.dumps({"triangles": len(corners), "mrays": SIDE * SIDE / traced / 1e6, "errors": off}))


def trimray_rate(binary, path):
    """Millions of primary first hits a second on one thread."""
    command = [binary, "bench", "stages", path, "--frames", "--device", "cpu", "--json"]
    command += ["--repeat", "3", "--warm-ups", "1", "--resolution", f"{SIDE},{SIDE}", "--rays-per-pixel", "1", "--rays", "1000"]
    environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
    out = subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout
    stages = json.loads(out.splitlines()[0])
    return stages["primary_rays"] / stages["seconds"]["primary"] / 1e6


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
    row["embree"].update(triangles=told["triangles"], mrays=told["mrays"], error=told["errors"][0])
    row["trimray"].update(mrays=trimray_rate(arguments.bin, str(path)), error=told["errors"][1])
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
    print(f"{'f3d':>14}{'Open CASCADE + Embree':>42}{'trimray':>36}")
    print(f"{'s':>8}{'MB':>6}" + 2 * f"{'s':>8}{'MB':>6}{'Mrays/s':>9}{'error':>9}" + f"{'triangles':>11}")
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
                numbers += f"{one['seconds']:8.2f}{one['megabytes']:6.0f}{one['mrays']:9.2f}{one['error']:9.1e}"
            print(f"{numbers}{row['embree']['triangles']:11}  {path.name}", flush=True)
    if arguments.json:
        Path(arguments.json).write_text("".join(json.dumps(row) + "\n" for row in rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
