#!/usr/bin/env python3
"""Import times of trimray and of Open CASCADE on the same files, in the same run.

    compare_import.py --bin target/release/trimray [--repeat 3] [--json OUT] FILE|FOLDER...

Open CASCADE: `STEPControl_Reader` or `IGESControl_Reader` as a user has them without settings,
`ReadFile` and `TransferRoots`, one shape at the end; measured inside the process, so that neither loading
the library nor Python counts. trimray: `bench stages --json`, file to model and file to baked scene.
Both read from the file cache, and of both the least of N repetitions counts. They take turns, file by
file; each file has processes of its own. Sums are over the files that both read.

Needs `cadquery-ocp` from PyPI.
"""

import argparse
import json
import multiprocessing
import subprocess
import sys
import time
from pathlib import Path

from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Controller, IGESControl_Reader
from OCP.Message import Message
from OCP.STEPControl import STEPControl_Controller, STEPControl_Reader

STEP, IGES = (".step", ".stp", ".p21"), (".iges", ".igs")


def occ_once(path: Path) -> tuple[float, float]:
    """Seconds of read and of transfer; raises where Open CASCADE makes no shape."""
    reader = STEPControl_Reader() if path.suffix.lower() in STEP else IGESControl_Reader()
    start = time.perf_counter()
    status = reader.ReadFile(str(path))
    read = time.perf_counter()
    if status != IFSelect_RetDone:
        raise ValueError("it cannot be read")
    reader.TransferRoots()
    shape = reader.OneShape()
    end = time.perf_counter()
    if shape.IsNull():
        raise ValueError("nothing is transferred")
    return read - start, end - read


def occ_worker(path: Path, repeat: int, answer) -> None:
    Message.DefaultMessenger_s().RemovePrinters(Message.DefaultMessenger_s().Printers().First().DynamicType())
    try:
        times = [occ_once(path) for _ in range(repeat)]
        answer.send(min(times, key=sum))
    except Exception as error:
        answer.send(str(error))


def occ(path: Path, repeat: int, limit: float):
    """(read, transfer) in seconds, or why there is none."""
    here, there = multiprocessing.Pipe(duplex=False)
    worker = multiprocessing.get_context("fork").Process(target=occ_worker, args=(path, repeat, there))
    worker.start()
    there.close()
    try:
        return here.recv() if here.poll(limit) else f"no answer in {limit} s"
    except EOFError:
        return "it crashes"
    finally:
        worker.kill()
        worker.join()


def trimray(binary: str, path: Path, repeat: int, limit: float):
    """The JSON of `bench stages`, or why there is none."""
    command = [binary, "bench", "stages", str(path), "--json", "--repeat", str(repeat)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return f"no answer in {limit} s"
    return json.loads(done.stdout) if done.returncode == 0 else done.stderr.strip()[-100:]


def files_of(arguments: list[Path]) -> list[Path]:
    found = []
    for path in arguments:
        inside = sorted(path.rglob("*")) if path.is_dir() else [path]
        found += [p for p in inside if p.is_file() and p.suffix.lower() in STEP + IGES]
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("inputs", nargs="+", type=Path)
    parser.add_argument("--bin", default="target/release/trimray")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--limit", type=float, default=600, help="seconds for one file")
    parser.add_argument("--json", help="also write all numbers to this file")
    arguments = parser.parse_args()
    STEPControl_Controller.Init_s()
    IGESControl_Controller.Init_s()
    rows, sums, left_out = [], [0.0, 0.0, 0.0], []
    print(f"{'MB':>7} {'OCC s':>8} {'model s':>8} {'x':>6} {'baked s':>8} {'x':>6}  file")
    for path in files_of(arguments.inputs):
        theirs = occ(path, arguments.repeat, arguments.limit)
        ours = trimray(arguments.bin, path, arguments.repeat, arguments.limit)
        rows.append({"file": str(path), "occ": theirs, "trimray": ours})
        if isinstance(theirs, str) or isinstance(ours, str):
            left_out.append((path, theirs, ours))
            continue
        times = [sum(theirs), ours["seconds"]["import"], ours["seconds"]["total"]]
        sums = [a + b for a, b in zip(sums, times)]
        print(line(ours["bytes"], times, path.name), flush=True)
    print(line(sum(r["trimray"]["bytes"] for r in rows if isinstance(r["trimray"], dict)), sums, "sum"))
    for path, theirs, ours in left_out:
        said = [f"{who}: {why}" for who, why in (("Open CASCADE", theirs), ("trimray", ours)) if isinstance(why, str)]
        print(f"left out: {path.name}: {'; '.join(said)}")
    if arguments.json:
        Path(arguments.json).write_text(json.dumps(rows, indent=1))
    sys.exit(0 if rows else 1)


def line(size: int, times: list[float], name: str) -> str:
    occ_time, model, baked = times
    return (
        f"{size * 1e-6:7.2f} {occ_time:8.3f} {model:8.4f} {occ_time / model:6.1f} "
        f"{baked:8.4f} {occ_time / baked:6.1f}  {name}"
    )


if __name__ == "__main__":
    main()
