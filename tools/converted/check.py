#!/usr/bin/env python3
"""Converts scenes to Mitsuba 3, and asks Mitsuba whether the result shows what we see in the original.

    python3 tools/converted/check.py FOLDER... [--binary target/release/caustica] [--seconds 60] [--only TEXT]

Every .xml and .pbrt below the folders that is a scene of its own is converted to .xml in a temporary folder. The
original is rendered by path tracing, the result by Mitsuba, both with a box filter and eight seeds, and the means of
the pictures are compared. The table has a line for each scene: verdict, difference of the means, its standard error
from the spread over the seeds, samples a pixel and seed, number of losses, and the largest loss that was measured.

Verdicts: `equal` when the difference and two standard errors together are at most 1 %; `DIFFERENT` when the
difference is above 1 % and three standard errors; `loss` instead of that where a loss that changes the light was
named; `undecided` when the noise leaves both open. What is undecided is rendered again with four times the samples,
until --samples or --seconds. The exit status is 1 when a scene without losses that matter differs, or Mitsuba refuses
what was written.
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

# Losses that do not change the light.
HARMLESS = ("the setting", "the integrator", "the sampler", "near and far clip", "a further sensor",
            "black on its back", "filter", "pictures as", "the scale in a sensor's to_world", "the seed",
            "samples a pixel")
TOLERANCE = 1.0
SEEDS = 8
SIDE = 64


class Failed(Exception):
    """The verdict and what was said."""


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


def by_mitsuba(scene, samples):
    """Prints the mean for each seed; runs in a process of its own."""
    import mitsuba
    import numpy
    try:
        mitsuba.set_variant("llvm_ad_rgb")
        mitsuba.Float([1, 2]) + 1
    except Exception:
        mitsuba.set_variant("scalar_rgb")
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    scene = mitsuba.load_file(scene)
    for seed in range(SEEDS):
        picture = numpy.array(mitsuba.render(scene, spp=samples, seed=seed))[..., :3]
        print(repr(float(picture.reshape(-1, 3).astype(float).mean(0) @ [0.2126, 0.7152, 0.0722])), flush=True)


def shrunk(made):
    """Writes a small copy of a converted scene beside it; its path, and the size of its film."""
    document = xml.etree.ElementTree.parse(made)
    size = None
    for film in document.iter("film"):
        sizes = {e.get("name"): e for e in film.findall("integer")}
        whole = [int(sizes[name].get("value")) for name in ("width", "height")]
        new = [max(1, round(n * min(1, SIDE / max(whole)))) for n in whole]
        for name, n in zip(("width", "height"), new):
            sizes[name].set("value", str(n))
        for name, e in sizes.items():
            if name.startswith("crop"):
                film.remove(e)
        for tag in film.findall("rfilter"):
            film.remove(tag)
        xml.etree.ElementTree.SubElement(film, "rfilter", type="box")
        for format in film.findall("string"):
            if format.get("name") == "pixel_format":
                format.set("value", "rgb")
        size = size or new
    small = made.with_name("small.xml")
    document.write(small)
    return small, size


def run(command, until, verdict):
    left = until - time.monotonic()
    try:
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=max(left, 1))
    except subprocess.TimeoutExpired:
        raise Failed("slow", "out of time") from None
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        first = next((line for line in lines if line.startswith("error")), lines[-1] if lines else "")
        raise Failed(verdict, (first if verdict == "unread" else lines[-1] if lines else "")[:100])
    return done


def ours(args, path, folder, size, samples, until):
    width, height = size
    means = []
    for seed in range(SEEDS):
        out = folder / "ours.pfm"
        run([args.binary, "render", path, "-o", out, "--integrator", "path", "--spp", samples, "--seed", seed + 1,
             "--size", f"{width}x{height}", "--crop", f"0,0,{width},{height}", "--filter", "box", "--lenient",
             "--quiet", "--allow-path", path.parent.parent], until, "unread")
        means.append(mean_of_pfm(out))
    return means


def mean_of_pfm(path):
    import numpy
    kind, size, _, data = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    channels = 3 if kind == b"PF" else 1
    pixels = numpy.frombuffer(data, "<f4", width * height * channels).reshape(-1, channels).astype(float).mean(0)
    return float(pixels @ [0.2126, 0.7152, 0.0722]) if channels == 3 else float(pixels[0])


def verdict_of(bias, noise, losses):
    if abs(bias) + 2 * noise <= TOLERANCE:
        return "equal"
    if abs(bias) > max(TOLERANCE, 3 * noise):
        return "loss" if losses else "DIFFERENT"
    return "undecided"


def check(args, path, folder):
    until = time.monotonic() + args.seconds
    made, report = folder / "made.xml", folder / "losses.json"
    try:
        run([args.binary, "convert", path, made, "--lenient", "--allow-path", path.parent.parent, "--report", report],
            until, "unread")
        losses = json.loads(report.read_text())
        real = [loss for loss in losses if not any(word in loss["what"] for word in HARMLESS)]
        sized = [loss for loss in real if loss["size"] is not None]
        largest = max(sized, key=lambda loss: abs(loss["size"]), default=None)
        about = f"{largest['size']:+.0%} {largest['what']}" if largest else (real[0]["what"] if real else "")
        small, size = shrunk(made)
    except Failed as failed:
        verdict, said = failed.args
        return (verdict, "", "", "", "", said)
    samples, row = 16, None
    while True:
        try:
            said = run([sys.executable, __file__, "--mitsuba", small, samples], until, "REFUSED").stdout
            theirs = [float(line) for line in said.split()]
            mine = ours(args, path, folder, size, samples, until)
        except Failed as failed:
            verdict, said = failed.args
            return row or (verdict, "", "", str(samples), str(len(real)), said)
        before = statistics.fmean(mine)
        after = statistics.fmean(theirs)
        if before == after == 0:
            return ("equal", "+0.00", "0.00", str(samples), str(len(real)), "black")
        error = ((statistics.variance(mine) + statistics.variance(theirs)) / SEEDS) ** 0.5
        scale = 100 / max(abs(before), 1e-300)
        bias, noise = scale * (after - before), scale * error
        verdict = verdict_of(bias, noise, real)
        row = (verdict, f"{bias:+.2f}", f"{noise:.2f}", str(samples), str(len(real)), about)
        if verdict != "undecided" or samples >= args.samples:
            return row
        samples *= 4


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--binary", default="target/release/caustica")
    parser.add_argument("--seconds", type=float, default=60, help="for one scene")
    parser.add_argument("--samples", type=int, default=1024, help="most samples a pixel and seed")
    parser.add_argument("--only", default="")
    args = parser.parse_args()
    counts = {}
    print("verdict | bias % | noise % | samples | losses | largest | scene")
    for path in scenes(args.folders):
        if args.only not in str(path):
            continue
        with tempfile.TemporaryDirectory() as folder:
            row = check(args, path, pathlib.Path(folder))
        counts[row[0]] = counts.get(row[0], 0) + 1
        print(" | ".join((*row, str(path))), flush=True)
    print("; ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items())))
    return 1 if counts.get("DIFFERENT") or counts.get("REFUSED") else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--mitsuba"]:
        by_mitsuba(sys.argv[2], int(sys.argv[3]))
    else:
        sys.exit(main())
