#!/usr/bin/env python3
"""The rival of `trimray bench work`: Open CASCADE's mesh of the same model, traced by Embree.

    pip install cadquery-ocp embreex numpy
    python3 tools/rival/mesh_embree.py fixtures/mug/model.step --bin target/release/trimray --csv mesh.csv
    trimray bench work fixtures/mug/model.step --rival mesh.csv --plot work.svg

For chord errors of 1e-2 to 1e-6 of the diagonal: meshing and tree building time, bytes, nanoseconds a ray on one thread (least of 5), and the
errors of first hits against `trimray probe --precision f64`, in diagonals. A hit more than 1e-2 diagonals off is another one: it counts as missed.
Embree runs through embreex, ray by ray, as single rays are traced by `trimray bench work` too. Bytes are three vertices of three floats
a triangle, which embreex stores, plus what the process grew by while Embree built its tree.
A mesh that would take too long (--limit, seconds) ends the series.
"""
import argparse
import ctypes
import gc
import json
import math
import os
import subprocess
import tempfile
import time

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Reader
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

# The name of the cast changed between releases of the package.
to_face = getattr(TopoDS, "Face_s", None) or TopoDS.Face

COLUMNS = "model,series,setting,build_seconds,bytes,nanoseconds,median,p99,p999,max,compared,missed,phantom"
ELSEWHERE = 1e-2
RUNS = 5


def read(path):
    is_iges = path.lower().endswith((".igs", ".iges"))
    reader = IGESControl_Reader() if is_iges else STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone:
        raise SystemExit(f"{path}: Open CASCADE does not read it")
    reader.TransferRoots()
    return reader.OneShape()


def triangles(shape, deflection):
    """Vertices of all triangles, (n, 3, 3), of a fresh mesh."""
    BRepTools.Clean_s(shape)
    BRepMesh_IncrementalMesh(shape, deflection, False, 0.5, False)
    found = []
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        place = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(to_face(explorer.Current()), place)
        explorer.Next()
        if mesh is None:
            continue
        move = place.Transformation()
        nodes = []
        for index in range(1, mesh.NbNodes() + 1):
            point = mesh.Node(index).Transformed(move)
            nodes.append((point.X(), point.Y(), point.Z()))
        corners = [mesh.Triangle(index).Get() for index in range(1, mesh.NbTriangles() + 1)]
        if corners:
            found.append(np.array(nodes)[np.array(corners) - 1])
    return np.concatenate(found)


def halton(count, base):
    values = np.zeros(count)
    for k in range(count):
        index, scale = k + 1, 1.0
        while index > 0:
            scale /= base
            values[k] += scale * (index % base)
            index //= base
    return values


def chords(center, radius, count):
    """As in src/bench/rays.rs."""
    def on_sphere(a, b):
        z = 1 - 2 * a
        across = np.sqrt(np.maximum(0, 1 - z * z))
        return np.stack([across * np.cos(2 * math.pi * b), across * np.sin(2 * math.pi * b), z], axis=1)

    start = on_sphere(halton(count, 2), halton(count, 3))
    end = on_sphere(halton(count, 5), halton(count, 7))
    direction = end - start
    length = np.linalg.norm(direction, axis=1, keepdims=True)
    direction = np.where(length > 0, direction / np.maximum(length, 1e-300), [0, 0, 1])
    return center + start * radius - direction * radius, direction


def first_hits(binary, path, origins, directions, precision="f64"):
    """Distances of trimray's first hits; infinite where there is none."""
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as rays:
        for o, d in zip(origins, directions):
            rays.write(" ".join(repr(float(x)) for x in (*o, *d)) + "\n")
        rays.flush()
        command = [binary, "probe", path, "--rays", rays.name, "--hits", "first", "--precision", precision, "--device", "cpu"]
        lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    hits = [json.loads(line)["hits"] for line in lines]
    return np.array([h[0]["t"] if h else math.inf for h in hits])


def resident():
    """Bytes of memory that are in use: what has been freed is given back first."""
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def errors(found, truth, diagonal):
    """How far first hits are off where both meet the model, in diagonals, ascending; what is ELSEWHERE is another hit."""
    both = np.isfinite(found) & np.isfinite(truth)
    error = np.sort(np.abs(found[both] - truth[both]) / diagonal)
    return error[error <= ELSEWHERE]


def quantile(ascending, share):
    """Not a number where there are none."""
    return float(ascending[min(len(ascending) - 1, int(len(ascending) * share))]) if len(ascending) else math.nan


def distances(scene, origins, directions):
    """Embree's first hits; infinite where there is none."""
    found = np.asarray(scene.run(origins, directions, query="DISTANCE"), dtype=float)
    return np.where(found > 1e30, math.inf, found)


def built(corners):
    """The scene of a mesh with its tree, seconds to build it."""
    clock = time.perf_counter()
    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, corners)
    one = np.zeros((1, 3), dtype=np.float32)
    scene.run(one, one + 1)
    return scene, time.perf_counter() - clock


def built_and_sized(corners):
    """The scene of a mesh with its tree, seconds to build it, bytes of both."""
    before = resident()
    scene, seconds = built(corners)
    return scene, seconds, max(corners.nbytes, resident() - before)


def measure(corners, origins, directions, truth, diagonal):
    """Seconds to build the tree, bytes, nanoseconds a ray, quantiles of the error, missed, phantom."""
    corners = corners.astype(np.float32)
    origins, directions = origins.astype(np.float32), directions.astype(np.float32)
    scene, build, size = built_and_sized(corners)
    least = math.inf
    for _ in range(RUNS):
        clock = time.perf_counter()
        scene.run(origins, directions, query="DISTANCE")
        least = min(least, time.perf_counter() - clock)
    found = distances(scene, origins, directions)
    near = errors(found, truth, diagonal)
    missed = int(np.sum(np.isfinite(truth))) - len(near)
    phantom = int(np.sum(np.isfinite(found) & ~np.isfinite(truth)))
    at = [quantile(near, share) for share in (0.5, 0.99, 0.999, 1.0)]
    return build, size, least / len(origins) * 1e9, at, missed, phantom


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model")
    parser.add_argument("--bin", default="target/release/trimray")
    parser.add_argument("--rays", type=int, default=100_000)
    parser.add_argument("--csv")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds that a mesh may take, guessed from the one before")
    arguments = parser.parse_args()

    shape = read(arguments.model)
    coarse = triangles(shape, 1e3)
    low, high = coarse.min(axis=(0, 1)), coarse.max(axis=(0, 1))
    diagonal = float(np.linalg.norm(high - low))
    origins, directions = chords((low + high) / 2, diagonal / 2, arguments.rays)
    truth = first_hits(arguments.bin, arguments.model, origins, directions)
    rows, last = [], 0.0
    print(f"{'chord error':>12}{'triangles':>12}{'build, s':>10}{'bytes':>13}{'ns/ray':>9}{'median':>10}{'p99.9':>10}{'max':>10}{'missed':>8}{'phantom':>8}")
    for power in np.arange(-2, -6.01, -0.5):
        share = 10.0**power
        # Triangles grow as 1 / error, and time with them.
        if last * 10**0.5 > arguments.limit:
            print(f"{share:12.0e}  would take more than {arguments.limit:.0f} s")
            break
        clock = time.perf_counter()
        corners = triangles(shape, share * diagonal)
        meshing = time.perf_counter() - clock
        build, size, time_of_ray, (median, p99, p999, most), missed, phantom = measure(
            corners, origins, directions, truth, diagonal)
        last = meshing + build
        print(f"{share:12.1e}{len(corners):12}{last:10.3f}{size:13}{time_of_ray:9.0f}{median:10.1e}{p999:10.1e}{most:10.1e}{missed:8}{phantom:8}", flush=True)
        rows.append(f"{arguments.model},mesh + Embree,{share:g},{last:g},{size},{time_of_ray:.1f},{median:g},{p99:g},{p999:g},{most:g},{arguments.rays},{missed},{phantom}")
    if arguments.csv:
        with open(arguments.csv, "w") as out:
            out.write("\n".join([COLUMNS, *rows]) + "\n")


if __name__ == "__main__":
    main()
