#!/usr/bin/env python3
"""Judges the rows of compare.py: enough rays of the STEP files agree, and no file makes trimray crash or hang."""
import json
import sys

FLOOR = 0.85  # share of rays that must agree, over all STEP files, refused ones counted as wrong
RAYS_OF_A_REFUSED_FILE = 200

rows = [row for row in json.load(open(sys.argv[1])) if row["file"].lower().endswith((".step", ".stp", ".p21"))]
answered = [row for row in rows if "agree" in row]
failed = [row for row in rows if "fail" in row]
crashed = [row for row in failed if "panicked" in row["fail"] or "rc 101" in row["fail"] or "rc -" in row["fail"] or "no answer" in row["fail"]]
rays = sum(row["rays"] for row in answered) + RAYS_OF_A_REFUSED_FILE * len(failed)
share = sum(row["agree"] for row in answered) / max(1, rays)
print(f"STEP files: {len(answered)} answered, {len(failed)} refused, {len(crashed)} crashed or hung; "
      f"{share:.4f} of {rays} rays agree (floor {FLOOR})")
for row in failed:
    print(f"  {row['file']}: {row['fail']}")
if crashed or share < FLOOR or not answered:
    sys.exit("the corpus check fails")
