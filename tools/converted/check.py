#!/usr/bin/env python3
"""Converts scenes to Mitsuba 3, and asks Mitsuba whether the result shows what we see in the original.

    python3 tools/converted/check.py FOLDER... [--binary target/release/caustica] [--seconds 60] [--only TEXT]

Every .xml and .pbrt below the folders that is a scene of its own is converted to .xml in a temporary folder and
checked by `caustica convert --check-with mitsuba`. The table has a line for each: verdict, difference of the means,
noise, number of losses, and the largest loss that was measured. The exit status is 1 when a scene without losses
that matter differs, or Mitsuba refuses what was written.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

DIFFERENCE = re.compile(r"check with .*: ([+-][\d.]+|[+-]?inf|NaN) % \(noise ([\d.]+|NaN) %\): (\w+)")
# Losses that do not change the light.
HARMLESS = ("the setting", "the integrator", "the sampler", "near and far clip", "a further sensor",
            "black on its back", "filter", "pictures as", "the scale in a sensor's to_world")


def scenes(folders):
    for folder in folders:
        folder = pathlib.Path(folder)
        found = [folder] if folder.is_file() else sorted(folder.rglob("*"))
        for path in found:
            if path.suffix not in (".xml", ".pbrt") or not path.is_file():
                continue
            text = path.read_bytes()[:4_000_000]
            whole = b"WorldBegin" in text if path.suffix == ".pbrt" else b"<scene" in text and b"<sensor" in text
            if whole:
                yield path


def check(binary, path, seconds, folder):
    out, report = folder / "made.xml", folder / "losses.json"
    command = [binary, "convert", path, out, "--force", "--lenient", "--check-with", "mitsuba",
               "--allow-path", path.parent.parent, "--report", report]
    report.unlink(missing_ok=True)
    try:
        run = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return ("slow", "", "", "", f"more than {seconds} s")
    losses = json.loads(report.read_text()) if report.exists() else []
    real = [loss for loss in losses if not any(word in loss["what"] for word in HARMLESS)]
    sized = [loss for loss in real if loss["size"] is not None]
    largest = max(sized, key=lambda loss: abs(loss["size"]), default=None)
    about = f"{largest['size']:+.0%} {largest['what']}" if largest else (real[0]["what"] if real else "")
    found = DIFFERENCE.search(run.stdout)
    if found:
        bias, noise, word = found.groups()
        verdict = "equal" if word == "equal" else ("loss" if real else "DIFFERENT")
        return (verdict, bias, noise, str(len(real)), about)
    last = [line for line in run.stderr.splitlines() if line.strip()]
    if "mitsuba refuses" in run.stderr:
        return ("REFUSED", "", "", str(len(real)), last[-1][:100])
    return ("unread", "", "", "", next((line for line in last if line.startswith("error")), last[-1] if last else "")[:100])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--binary", default="target/release/caustica")
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--only", default="")
    args = parser.parse_args()
    counts = {}
    print("verdict | bias % | noise % | losses | largest | scene")
    for path in scenes(args.folders):
        if args.only not in str(path):
            continue
        with tempfile.TemporaryDirectory() as folder:
            row = check(args.binary, path, args.seconds, pathlib.Path(folder))
        counts[row[0]] = counts.get(row[0], 0) + 1
        print(" | ".join((*row, str(path))), flush=True)
    print("; ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items())))
    return 1 if counts.get("DIFFERENT") or counts.get("REFUSED") else 0


if __name__ == "__main__":
    sys.exit(main())
