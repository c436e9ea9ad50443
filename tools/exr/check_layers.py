#!/usr/bin/env python3
"""Checks an EXR file of trimray's with the reference library: names and types of its layers, its windows, and that its Cryptomatte keeps to
Psyop's specification 1.2, so that what is in a pixel can be found by name.

    pip install OpenEXR
    trimray render part.step -o part.exr --no-background
    python3 tools/exr/check_layers.py part.exr
"""

import json
import struct
import sys

import numpy
import OpenEXR

# Names, and the types that they have where they are there.
LAYERS = {
    **{name: numpy.float16 for name in ("R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B")},
    **{f"{layer}.{axis}": numpy.float32 for layer in ("normal", "position") for axis in "XYZ"},
    **{name: numpy.float32 for name in ("uv.U", "uv.V", "mean_curvature.V", "gaussian_curvature.V", "depth.Z")},
    **{name: numpy.uint32 for name in ("id.part", "id.face", "trim.tests")},
}
RANKS = 6


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


def check(path: str) -> None:
    # The library forgets the file's contents where it is closed.
    with OpenEXR.File(path, separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
        check_layers(path, file.header(), channels)
        if "CryptoObject00.R" in channels:
            check_cryptomatte(file.header(), channels)


def check_layers(path: str, header: dict, channels: dict) -> None:
    (low, high), (least, most) = header["dataWindow"], header["displayWindow"]
    height, width = next(iter(channels.values())).shape
    assert tuple(high - low + 1) == (width, height), "the data window is that of the samples"
    assert (low >= least).all() and (high <= most).all(), "the data are within the picture"
    for name, pixels in channels.items():
        expected = numpy.float32 if name.startswith("CryptoObject") else LAYERS[name]
        assert pixels.dtype == expected, f"{name} is {pixels.dtype}"
    print(f"{path}: {width} by {height} at {tuple(int(x) for x in low)}, {len(channels)} channels")


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
    for argument in sys.argv[1:]:
        check(argument)
