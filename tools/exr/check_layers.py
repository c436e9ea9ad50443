#!/usr/bin/env python3
"""Checks an EXR file of trimray's with the reference library: names, types and values of its layers, its windows, and that its Cryptomatte keeps to
Psyop's specification 1.2, so that what is in a pixel can be found by name. With the model, its id map and the program, what `trimray probe` finds at the
places that pixels show is what the pixels say: part, face, normal and parameters.

    pip install OpenEXR
    trimray render part.step -o part.exr --no-background --edges feature --id-map part.json
    python3 tools/exr/check_layers.py part.exr
    python3 tools/exr/check_layers.py part.exr --model part.step --id-map part.json --bin trimray
"""

import argparse
import json
import math
import struct
import subprocess

import numpy
import OpenEXR

# Names, and the types that they have where they are there.
LAYERS = {
    **{name: numpy.float16 for name in ("R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B", "edges.A")},
    **{f"{layer}.{axis}": numpy.float32 for layer in ("normal", "position") for axis in "XYZ"},
    **{name: numpy.float32 for name in ("uv.U", "uv.V", "mean_curvature.V", "gaussian_curvature.V", "depth.Z")},
    **{name: numpy.uint32 for name in ("id.part", "id.face", "trim.tests")},
}
RANKS = 6
# Pixels that are probed, at most.
PROBED = 4000


def murmur3(text: str) -> int:
    """MurmurHash3_x86_32 with seed 0, as the specification asks."""
    data, mask = text.encode(), 0xFFFFFFFF
    rotate = lambda x, r: (x << r | x >> (32 - r)) & mask
    value = 0
    padded = data + bytes(-len(data) % 4)
    for at in range(0, len(padded), 4):
        k = rotate(int.from_bytes(padded[at : at + 4], "little") * 0xCC9E2D51 & mask, 15) * 0x1B873593 & mask
        value ^= k
        if at + 4 <= len(data):
            value = (rotate(value, 13) * 5 + 0xE6546B64) & mask
    value ^= len(data)
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35), (16, 1)):
        value = (value ^ value >> shift) * factor & mask
    return value


def matte_id(name: str) -> int:
    """A hash whose exponent makes it a normal f32."""
    value = murmur3(name)
    return value ^ 1 << 23 if value >> 23 & 255 in (0, 255) else value


def bits(number: float) -> int:
    return struct.unpack("<I", struct.pack("<f", number))[0]


def check(path: str, arguments) -> None:
    # The library forgets the file's contents where it is closed.
    with OpenEXR.File(path, separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
        check_layers(path, file.header(), channels)
        if "CryptoObject00.R" in channels:
            check_cryptomatte(file.header(), channels)
        if arguments.model:
            check_hits(arguments, channels)


def check_layers(path: str, header: dict, channels: dict) -> None:
    (low, high), (least, most) = header["dataWindow"], header["displayWindow"]
    height, width = next(iter(channels.values())).shape
    assert tuple(high - low + 1) == (width, height), "the data window is that of the samples"
    assert (low >= least).all() and (high <= most).all(), "the data are within the picture"
    for name, pixels in channels.items():
        expected = numpy.float32 if name.startswith("CryptoObject") else LAYERS[name]
        assert pixels.dtype == expected, f"{name} is {pixels.dtype}"
    check_values(channels)
    print(f"{path}: {width} by {height} at {tuple(int(x) for x in low)}, {len(channels)} channels")


def vectors(channels: dict, layer: str) -> numpy.ndarray:
    return numpy.stack([channels[f"{layer}.{axis}"].astype(float) for axis in "XYZ"], axis=-1)


def check_values(channels: dict) -> None:
    """What holds of layers whatever the model is; only of those that are there."""
    for name in ("A", "edges.A"):
        if name in channels:
            assert ((channels[name] >= 0) & (channels[name] <= 1)).all(), f"{name} is from 0 to 1"
    shows = channels["id.part"] > 0 if "id.part" in channels else None
    if shows is None:
        return
    assert not channels["id.face"][~shows].any(), "where there is no part there is no face"
    if "depth.Z" in channels:
        assert (numpy.isfinite(channels["depth.Z"]) == shows).all(), "depth is finite where something is"
    if "normal.X" in channels:
        length = numpy.linalg.norm(vectors(channels, "normal"), axis=-1)
        assert (abs(length - shows) < 1e-5).all(), "normals are unit vectors, or 0 where nothing is"
    if "mean_curvature.V" in channels:
        mean, gaussian = (channels[f"{name}_curvature.V"].astype(float) for name in ("mean", "gaussian"))
        # Of two numbers the square of the mean is at least the product.
        assert (mean**2 - gaussian >= -1e-5 * numpy.maximum(mean**2, 1e-12)).all(), "curvatures are those of a surface"
        flat = (channels["id.face"] == 0) | ~shows
        assert not mean[flat].any() and not gaussian[flat].any(), "caps, and where nothing is, are flat"


def check_hits(arguments, channels: dict) -> None:
    with open(arguments.id_map, encoding="utf-8") as file:
        ids = json.load(file)
    face, part = channels["id.face"], channels["id.part"]
    # At a border of a face either neighbour may be hit.
    inner = face > 0
    for axis, step in ((0, 1), (0, -1), (1, 1), (1, -1)):
        inner &= (numpy.roll(face, step, axis) == face) & (numpy.roll(part, step, axis) == part)
    inner[[0, -1], :] = inner[:, [0, -1]] = False
    rows, columns = (places[:: max(1, inner.sum() // PROBED)] for places in numpy.nonzero(inner))
    place, normal = (vectors(channels, layer)[rows, columns] for layer in ("position", "normal"))
    size = numpy.ptp(place, axis=0).max()
    above = 1e-4 * size
    rays = "\n".join(" ".join(map(repr, map(float, (*ray[0], *ray[1])))) for ray in zip(place + above * normal, -normal))
    command = [arguments.bin, "probe", arguments.model, "--rays", "-", "--hits", "first"]
    answers = subprocess.run(command, input=rays, capture_output=True, text=True, check=True).stdout.splitlines()
    for index, answer in enumerate(answers):
        at = (rows[index], columns[index])
        (hit,) = json.loads(answer)["hits"]
        told, shown = ids["faces"][face[at] - 1], ids["parts"][part[at] - 1]
        assert hit["entity"] == told["entity"], f"{at}: face {hit['entity']} for {told['entity']}"
        assert hit["part"] == shown["name"] == told["part"], f"{at}: part {hit['part']} for {shown['name']}"
        assert abs(hit["t"] - above) < 1e-5 * size, f"{at}: {hit['t']} for {above}"
        assert abs(numpy.dot(hit["n"], normal[index])) > 1 - 1e-6, f"{at}: normal {hit['n']} for {normal[index]}"
        for name, value in (("uv.U", hit["u"]), ("uv.V", hit["v"])):
            apart = abs(float(channels[name][at]) - value)
            # Angles may be a whole turn apart.
            assert min(apart, abs(apart - math.tau)) < 1e-4 * max(1.0, size), f"{at}: {name} {value} is {apart} off"
    print(f"  {len(answers)} pixels of {len(numpy.unique(face[rows, columns]))} faces are what probe finds there")


def check_cryptomatte(header: dict, channels: dict) -> None:
    keys = {key.rsplit("/", 1)[1]: value for key, value in header.items() if key.startswith("cryptomatte/")}
    prefix = f"cryptomatte/{murmur3('CryptoObject'):08x}"[: len("cryptomatte/") + 7]
    assert all(f"{prefix}/{field}" in header for field in ("name", "hash", "conversion", "manifest"))
    assert (keys["name"], keys["hash"], keys["conversion"]) == ("CryptoObject", "MurmurHash3_32", "uint32_to_float32")
    manifest = json.loads(keys["manifest"])
    for name, text in manifest.items():
        assert int(text, 16) == matte_id(name), f"the hash of {name}"
    names = {int(text, 16): name for name, text in manifest.items()}
    pairs = [(f"CryptoObject{rank // 2:02}.{'RB'[rank % 2]}", f"CryptoObject{rank // 2:02}.{'GA'[rank % 2]}") for rank in range(RANKS)]
    covers = numpy.stack([channels[coverage] for _, coverage in pairs])
    assert (covers[:-1] >= covers[1:]).all(), "the greatest share is first"
    assert (covers.sum(axis=0) <= 1 + 1e-5).all(), "no pixel is covered twice"
    found: dict[str, float] = {}
    for id_name, cover_name in pairs:
        for number, coverage in zip(channels[id_name].ravel(), channels[cover_name].ravel()):
            if coverage > 0:
                name = names[bits(number)]
                found[name] = found.get(name, 0.0) + float(coverage)
    for name, pixels in sorted(found.items(), key=lambda item: -item[1]):
        print(f"  {pixels:10.1f} pixels: {name}")
    # A part's matte is the ids of the pixels that it fills.
    full = channels["CryptoObject00.G"] == 1
    if "id.part" in channels:
        numbers = {}
        for part, number in zip(channels["id.part"][full], channels["CryptoObject00.R"][full]):
            assert numbers.setdefault(int(part), bits(number)) == bits(number), f"part {part} has two hashes"
        print(f"  {full.sum()} pixels of one part agree with id.part")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--model", help="the CAD file that the pictures show")
    parser.add_argument("--id-map", help="the JSON file of render --id-map")
    parser.add_argument("--bin", default="trimray")
    chosen = parser.parse_args()
    for chosen_file in chosen.files:
        check(chosen_file, chosen)
