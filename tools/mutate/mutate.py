#!/usr/bin/env python3
"""Breaks CAD files at random and runs `trimray` on them, each in a process with limits.

Usage: mutate.py --bin target/release/trimray FILE_OR_FOLDER... [--count 2000] [--seed 1] [--largest 2000000]
                 [--cpu-seconds 20] [--megabytes 2048] [--threads 1] [--keep FOLDER]

Each run takes the next file, damages it one to four times (bits flipped, bytes changed, the end cut off, stretches moved or
dropped, numbers and references swapped or replaced by hostile ones) and has it imported, baked and hit by a few rays
through the original's box (`trimray probe`), every fourth one rendered small instead. A finding is a panic, a signal, more
processor time or memory than allowed. The damage is a function of seed and file alone; findings are kept in --keep.
Prints a line per finding, the totals, and the slowest and the largest run. Exit code 1 where something was found.
"""

import argparse
import json
import os
import random
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

SUFFIXES = {".step", ".stp", ".p21", ".igs", ".iges"}
NUMBERS = "1.E300 -1.E300 1.E-300 NAN INF -0. 0. -1. 1.E9 99999999999999999999 -5 0 1 2147483648 1.E $ * () ''".split()
TOKEN = re.compile(rb"[#+\-.\w$*]+")


def damage(data, rng):
    """`data` damaged once, behind the header as a rule."""
    begin = max(data.find(b"DATA;"), 0) if rng.random() < 0.95 else 0
    at = rng.randrange(begin, len(data))
    kind = rng.randrange(12)
    if kind == 0:
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
    if kind == 1:
        return data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1 :]
    if kind == 2:
        return data[:at]
    if kind == 3:
        other, length = rng.randrange(begin, len(data)), rng.randrange(200)
        return data[:other] + data[at : at + length] + data[other:]
    if kind == 4:
        return data[:at] + data[at + rng.randrange(200) :]
    token, other = TOKEN.search(data, at), TOKEN.search(data, rng.randrange(begin, len(data)))
    if not token or not other:
        return data
    new = other[0] if kind < 9 else rng.choice(NUMBERS).encode()
    if len(token[0]) >= len(new) and rng.random() < 0.5:
        # Columns stay where they are: IGES counts them.
        new = new.rjust(len(token[0]))
    return data[: token.start()] + new + data[token.end() :]


def rays(binary, path):
    """Five rays through the box of the original file, one a line."""
    answer = subprocess.run([binary, "info", "--json", path], capture_output=True, text=True)
    box = json.loads(answer.stdout).get("bbox") if answer.returncode in (0, 3, 4) and answer.stdout else None
    low, high = box or [[-10.0] * 3, [10.0] * 3]
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    size = max(b - a for a, b in zip(low, high)) or 1.0
    lines = []
    for direction in [(1, 0, 0), (0, 1, 0), (0, 0, -1), (1, 1, 1), (0.3, -0.8, 0.1)]:
        origin = [m - 3 * size * d for m, d in zip(middle, direction)]
        lines.append(" ".join(map(repr, [*origin, *direction])))
    return "\n".join(lines) + "\n"


def run(command, text, options):
    """What is wrong with the run of `command`, if anything; its processor seconds and megabytes."""

    def limit():
        # Above what is allowed, so that what exceeds it a little is measured and not killed.
        resource.setrlimit(resource.RLIMIT_CPU, (2 * options.cpu_seconds, 2 * options.cpu_seconds + 5))
        resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))

    with tempfile.TemporaryFile() as errors, tempfile.TemporaryFile() as rays_in:
        rays_in.write(text.encode())
        rays_in.seek(0)
        process = subprocess.Popen(
            command, stdin=rays_in, stdout=subprocess.DEVNULL, stderr=errors, preexec_fn=limit
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        said = errors.read().decode(errors="replace")
    seconds, megabytes = usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024
    wrong = None
    if "panicked" in said or process.returncode == 101:
        wrong = next(line for line in said.splitlines() if "panicked" in line or "101" in line)
    elif process.returncode < 0 or process.returncode > 4:
        wrong = f"exit code {process.returncode}"
    elif seconds > options.cpu_seconds:
        wrong = "too slow"
    elif megabytes > options.megabytes:
        wrong = "too large"
    return wrong, seconds, megabytes, process.returncode


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("inputs", nargs="+", type=Path)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--largest", type=int, default=2_000_000, help="bytes of a file")
    parser.add_argument("--cpu-seconds", type=int, default=20)
    parser.add_argument("--megabytes", type=int, default=2048)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--keep", type=Path, default=Path(tempfile.gettempdir()) / "trimray-mutations")
    options = parser.parse_args()
    files = [f for i in options.inputs for f in (sorted(i.rglob("*")) if i.is_dir() else [i])]
    files = [f for f in files if f.suffix.lower() in SUFFIXES and 0 < f.stat().st_size <= options.largest]
    through, findings, codes = {}, 0, {}
    slowest, largest = (0.0, 0), (0.0, 0)
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(options.seed, options.seed + options.count):
            path = files[seed % len(files)]
            rng = random.Random(f"{seed} {path.name}")
            data = path.read_bytes()
            for _ in range(rng.randrange(1, 5)):
                data = damage(data, rng) or data
            broken = Path(folder) / f"broken{path.suffix}"
            broken.write_bytes(data)
            if path not in through:
                through[path] = rays(options.bin, path)
            common = ["--device", "cpu", "--threads", str(options.threads)]
            command = [options.bin, "probe", broken, "--rays", "-", "--precision", "f64", *common]
            if seed % 4 == 0:
                image = Path(folder) / "picture.png"
                command = [options.bin, "render", broken, "-o", image, "--resolution", "24,16", "--samples", "1", *common]
            wrong, seconds, megabytes, code = run(command, through[path], options)
            codes[code] = codes.get(code, 0) + 1
            slowest, largest = max(slowest, (seconds, seed)), max(largest, (megabytes, seed))
            if sum(codes.values()) % 100 == 0:
                print(f"{sum(codes.values())} runs, {findings} findings", file=sys.stderr, flush=True)
            if wrong:
                findings += 1
                options.keep.mkdir(parents=True, exist_ok=True)
                kept = options.keep / f"{seed}-{path.name}"
                kept.write_bytes(data)
                print(f"seed {seed}: {wrong} ({seconds:.1f} s, {megabytes:.0f} MB): {kept}", flush=True)
    print(f"{options.count} broken files of {len(files)}: {findings} findings; exit codes {dict(sorted(codes.items()))}")
    print(f"slowest {slowest[0]:.1f} s (seed {slowest[1]}), largest {largest[0]:.0f} MB (seed {largest[1]})")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
