#!/usr/bin/env python3
"""Judges the rows of compare.py: enough rays agree on the STEP and on the IGES files, and no file makes trimray crash or hang."""
import json
import sys

FLOORS = {"STEP": 0.96, "IGES": 0.99}  # share of rays that must agree; refused files count as wrong
RAYS_OF_A_REFUSED_FILE = 200
CRASHES = ("panicked", "rc 101", "rc -", "no answer")


def judge(kind, rows):
    answered = [row for row in rows if "agree" in row]
    refused = [row for row in rows if "fail" in row]
    crashed = [row for row in refused if any(sign in row["fail"] for sign in CRASHES)]
    rays = sum(row["rays"] for row in answered) + RAYS_OF_A_REFUSED_FILE * len(refused)
    share = sum(row["agree"] for row in answered) / max(1, rays)
    print(f"{kind} files: {len(answered)} answered, {len(refused)} refused, {len(crashed)} crashed or hung; "
          f"{share:.4f} of {rays} rays agree (floor {FLOORS[kind]})")
    for row in refused:
        print(f"  {row['file']}: {row['fail']}")
    return not crashed and bool(answered) and share >= FLOORS[kind]


rows = json.load(open(sys.argv[1]))
is_iges = lambda row: row["file"].lower().endswith((".igs", ".iges"))
verdicts = [judge("STEP", [row for row in rows if not is_iges(row)]), judge("IGES", [row for row in rows if is_iges(row)])]
sys.exit(0 if all(verdicts) else "the corpus check fails")
