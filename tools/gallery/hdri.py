#!/usr/bin/env python3
"""Writes a small map of light as a Radiance file: an evening sky with a low sun, a bright window band and dark ground. hdri.py FILE.hdr"""
import math
import struct
import sys

WIDTH, HEIGHT = 512, 256


def light(across: float, up: float) -> tuple[float, float, float]:
    """Linear red, green, blue from an azimuth and an elevation, radians."""
    if up < 0:
        fade = math.exp(6 * up)
        return (0.05 + 0.25 * fade, 0.045 + 0.2 * fade, 0.04 + 0.15 * fade)
    low, high = (0.95, 0.6, 0.38), (0.12, 0.22, 0.5)
    share = min(1.0, (up / (math.pi / 2)) ** 0.5)
    sky = [a + (b - a) * share for a, b in zip(low, high)]
    off = math.acos(max(-1.0, min(1.0, math.sin(up) * math.sin(0.6) + math.cos(up) * math.cos(0.6) * math.cos(across + 0.9))))
    sun = 60.0 / (1.0 + math.exp((off - 0.07) * 120.0)) + 1.2 * math.exp(-off * 4.0)
    panel = 2.5 if abs(across - 1.6) < 0.35 and 0.15 < up < 1.0 else 0.0
    return (sky[0] + sun + panel, sky[1] + 0.8 * sun + panel, sky[2] + 0.55 * sun + panel)


def rgbe(channels: tuple[float, float, float]) -> bytes:
    mantissa, exponent = math.frexp(max(channels))
    scale = mantissa * 256.0 / max(channels)
    return struct.pack("4B", *(min(255, int(c * scale)) for c in channels), exponent + 128)


with open(sys.argv[1], "wb") as file:
    file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (HEIGHT, WIDTH))
    for row in range(HEIGHT):
        for column in range(WIDTH):
            across = ((column + 0.5) / WIDTH - 0.5) * math.tau
            file.write(rgbe(light(across, (0.5 - (row + 0.5) / HEIGHT) * math.pi)))
