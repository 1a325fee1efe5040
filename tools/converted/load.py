#!/usr/bin/env python3
"""Asks Mitsuba whether it loads converted scenes.

    python3 tools/converted/load.py FOLDER [--seconds 60]

Every made.xml below FOLDER (see `cargo run --example round_trips -- --keep FOLDER`) is loaded, not rendered. What
Mitsuba says of those it refuses is counted, with one example each. The exit status is 1 when there are any.
"""

import argparse
import collections
import multiprocessing
import pathlib
import re
import sys


def load(path):
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    try:
        mi.load_file(str(path))
    except Exception as problem:
        return str(problem)
    return None


def kind(message, path):
    """The message without what differs from file to file."""
    last = [line.strip() for line in message.replace(str(path.parent), "").splitlines() if line.strip()]
    words = " / ".join(last[-2:])
    return re.sub(r"0x[0-9a-f]+|-?\d+(\.\d+)?(e[+-]?\d+)?", "N", re.sub(r'"[^"]*"', '"…"', words))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--seconds", type=float, default=60)
    args = parser.parse_args()
    paths = sorted(args.folder.rglob("made.xml"))
    kinds = collections.defaultdict(list)
    loaded = 0
    # A scene that takes the interpreter down takes its process only.
    context = multiprocessing.get_context("spawn")
    pool = None
    for path in paths:
        pool = pool or context.Pool(1)
        try:
            problem = pool.apply_async(load, (path,)).get(args.seconds)
        except multiprocessing.TimeoutError:
            problem = "no answer: crashed or too slow"
            pool.terminate()
            pool = None
        if problem is None:
            loaded += 1
        else:
            kinds[kind(problem, path)].append(path)
    print(f"{len(paths)} scenes, {loaded} loaded by Mitsuba")
    for about, found in sorted(kinds.items(), key=lambda item: -len(item[1])):
        print(f"{len(found):4} {about}  e.g. {found[0]}")
    return 1 if kinds else 0


if __name__ == "__main__":
    sys.exit(main())
