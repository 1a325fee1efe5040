#!/usr/bin/env python3
"""Makes the references of reference/ with Mitsuba 3. See README.md beside this file.

    python3 tools/references/make.py [--venv DIR] [--limits] [NAME ...]

Without names: every row of scenes.toml. Needs Python 3.11 with venv; installs the rest into DIR.
"""

import argparse
import hashlib
import json
import os
import subprocess
import sys
import time
import tomllib
import xml.etree.ElementTree as ET
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CONFIG = Path(__file__).resolve().parent / "scenes.toml"
PACKAGES = {"mitsuba": "3.9.1", "numpy": "2.4.6", "OpenEXR": "3.5.3"}
LLVM = ["/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1", "/usr/lib/llvm-19/lib/libLLVM.so"]


def inside_venv(folder: Path) -> None:
    """Restarts the script in a virtual environment with the pinned packages, which is made if there is none."""
    python = folder / "bin" / "python"
    if os.path.realpath(sys.prefix) == os.path.realpath(folder):
        return
    wanted = [f"{name}=={version}" for name, version in PACKAGES.items()]
    check = "import importlib.metadata as m; print([f'{n}=={m.version(n)}' for n in %r])" % list(PACKAGES)
    have = subprocess.run([python, "-c", check], capture_output=True, text=True) if python.exists() else None
    if not have or have.stdout.strip() != str(wanted):
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", *wanted], check=True)
    os.execv(python, [str(python), *sys.argv])


def choose_variant(mi):
    """llvm_ad_rgb where LLVM is found (much faster), else scalar_rgb."""
    if "DRJIT_LIBLLVM_PATH" not in os.environ:
        found = [p for p in LLVM if Path(p).exists()]
        if found:
            os.environ["DRJIT_LIBLLVM_PATH"] = found[0]
    if "DRJIT_LIBLLVM_PATH" in os.environ:
        mi.set_variant("llvm_ad_rgb")
    else:
        mi.set_variant("scalar_rgb")
        print("LLVM was not found, so this is slow; install it with: apt-get install libllvm19", file=sys.stderr)
    return mi.variant()


def files_of(scene: Path) -> list[Path]:
    """The scene file and every file that it includes or refers to, each once."""
    found = [scene]
    for element in ET.parse(scene).iter():
        name = element.get("filename") if element.tag == "include" else None
        if element.tag == "string" and element.get("name") in ("filename", "normal_map"):
            name = element.get("value")
        if name:
            path = scene.parent / name
            inner = files_of(path) if path.suffix == ".xml" else [path]
            found += [p for p in inner if p not in found]
    return found


def load(mi, scene: Path, size: list[int]):
    """The scene with another size, a box filter and no integrator (some are not Mitsuba's), and the parameters of its
    integrator that change what the picture shows."""
    root = ET.parse(scene).getroot()
    keep = {}
    for integrator in root.findall("integrator"):
        for child in integrator:
            if child.get("name") == "max_depth":
                keep["max_depth"] = int(child.get("value"))
            if child.get("name") == "hide_emitters":
                keep["hide_emitters"] = child.get("value") == "true"
        root.remove(integrator)
    for sampler in root.findall("sensor/sampler"):
        for sensor in root.findall("sensor"):
            if sampler in list(sensor):
                sensor.remove(sampler)
    for film in root.findall("sensor/film"):
        for child in list(film):
            if child.tag == "rfilter" or child.get("name") in ("width", "height", "component_format", "pixel_format"):
                film.remove(child)
        for tag, name, value in [
            ("integer", "width", size[0]),
            ("integer", "height", size[1]),
            ("string", "component_format", "float32"),
            ("string", "pixel_format", "rgb"),
        ]:
            ET.SubElement(film, tag, name=name, value=str(value))
        ET.SubElement(film, "rfilter", type="box")
    mi.file_resolver().prepend(str(scene.parent))
    return mi.load_string(ET.tostring(root, encoding="unicode")), keep


def render(mi, scene, integrator: dict, spp: int, seeds: range):
    """Mean of the passes, variance of that mean, both float64, per pixel and channel."""
    import numpy as np

    integrator = mi.load_dict(integrator)
    total = square = None
    for seed in seeds:
        x = np.array(mi.render(scene, integrator=integrator, spp=spp, seed=seed), dtype=np.float64)
        if total is None:
            total, square, shift = np.zeros_like(x), np.zeros_like(x), x.copy()
        total += x - shift
        square += (x - shift) ** 2
    n = len(seeds)
    mean = total / n
    variance = (square / n - mean**2) / (n - 1) if n > 1 else np.zeros_like(mean)
    return mean + shift, np.maximum(variance, 0)


def specular_mask(mi, scene, size):
    """1 where all camera rays of a pixel and of its neighbours first hit a diffuse surface or nothing, 0 elsewhere. A
    particle tracer connects only such surfaces with the camera."""
    import numpy as np

    grid = 4
    columns = (np.arange(size[0] * grid) + 0.5) / (size[0] * grid)
    rows = (np.arange(size[1] * grid) + 0.5) / (size[1] * grid)
    x, y = (v.ravel() for v in np.meshgrid(columns, rows))
    delta = mi.BSDFFlags.Delta

    def meets_delta(u, v):
        ray, _ = scene.sensors()[0].sample_ray(0.0, 0.5, mi.Point2f(u, v), mi.Point2f(0.5))
        si = scene.ray_intersect(ray)
        if mi.variant().startswith("scalar"):
            return si.is_valid() and mi.has_flag(si.bsdf(ray).flags(), delta)
        return np.array(si.is_valid() & mi.has_flag(si.bsdf(ray).flags(), delta))

    if mi.variant().startswith("scalar"):
        seen = np.array([meets_delta(float(u), float(v)) for u, v in zip(x, y)])
    else:
        seen = meets_delta(x, y)
    hit = seen.reshape(size[1], grid, size[0], grid).any(axis=(1, 3))
    grown = hit.copy()
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            grown |= np.roll(hit, (dy, dx), (0, 1))
    return np.repeat((~grown)[:, :, None], 3, axis=2).astype(np.float64)


def bias_check(mi, row):
    """Compares the particle tracer with the path tracer on a scene where both find all light."""
    import numpy as np

    scene, keep = load(mi, ROOT / row["bias_check"], [96, 96])
    passes, spp = 32, 64
    a, va = render(mi, scene, {"type": "ptracer", **keep}, spp, range(1000, 1000 + passes))
    b, vb = render(mi, scene, {"type": "path", **keep}, spp, range(2000, 2000 + passes))
    n = a.shape[0] * a.shape[1]
    mean_a, mean_b = a.reshape(n, 3).mean(0), b.reshape(n, 3).mean(0)
    error = np.sqrt((va + vb).reshape(n, 3).sum(0)) / n / mean_b
    z2 = ((a - b) ** 2 / np.maximum(va + vb, 1e-12)).mean()
    return {
        "scene": row["bias_check"],
        "spp": passes * spp,
        "difference": [float(v) for v in (mean_a / mean_b - 1).round(6)],
        "standard_error": [float(v) for v in error.round(6)],
        "mean_z2": round(float(z2), 3),
    }


def toml(value) -> str:
    if isinstance(value, float):
        return f"{value:.6g}" if value else "0.0"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(v) for v in value) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {toml(v)}" for k, v in value.items()) + " }"
    return json.dumps(value, ensure_ascii=False)


def table(name: str, rows: dict) -> str:
    return f"\n[{name}]\n" + "".join(f"{k} = {toml(v)}\n" for k, v in rows.items())


def limits_text(mi, scene, row: dict, integrator: dict, measured, mask) -> str:
    """The limits for the manifest. Also writes how far the blocks of a density estimate may be off."""
    import density
    import limits
    from exr import write_exr

    take = lambda samples, seed: render(mi, scene, integrator, samples, range(seed, seed + 1))[0]
    pictures = limits.pictures(take, row.get("spp_suite", 256), mask)
    text = ""
    if row["integrator"] == "path":
        text += table("path", limits.path(measured, pictures, row.get("z_test", True)))
    direct, _ = render(mi, scene, {**integrator, "type": "path", "max_depth": 2}, 1024, range(900, 904))
    change, unknown = density.spread(mi, scene, measured.mean, direct, pictures.spp, mask)
    write_exr(measured.file.with_suffix(".density.exr"), density.tolerance(change, unknown))
    return text + table("photonmap", limits.photonmap(measured, pictures, change, row.get("photonmap_args", [])))


def renew_limits(mi, row: dict) -> None:
    """Computes the limits of an existing reference again."""
    import limits
    from exr import read_exr

    target = ROOT / "reference" / f"{row['name']}.exr"
    manifest = target.with_suffix(".toml")
    text = manifest.read_text()
    spp = tomllib.loads(text)["reference"]["spp"]
    scene, keep = load(mi, ROOT / row["scene"], row.get("size", [96, 96]))
    mean = read_exr(target)
    measured = limits.Measured(target, mean, read_exr(target.with_suffix(".var.exr")), spp)
    mask = read_exr(target.with_suffix(".mask.exr")) if row.get("mask") else None
    head = text.split("\n[path]\n")[0].split("\n[photonmap]\n")[0]
    integrator = {"type": row["integrator"], **keep}
    manifest.write_text(head + limits_text(mi, scene, row, integrator, measured, mask))
    print(f"{row['name']}: limits")


def make(mi, variant: str, row: dict) -> None:
    import drjit
    import limits
    import numpy as np
    from exr import write_exr

    scene_file = ROOT / row["scene"]
    name = row["name"]
    target = ROOT / "reference" / f"{name}.exr"
    manifest = target.with_suffix(".toml")
    size, passes, spp = row.get("size", [96, 96]), row.get("passes", 64), row.get("spp", 128)
    started = time.time()
    scene, keep = load(mi, scene_file, size)
    integrator = {"type": row["integrator"], **keep}
    mean, variance = render(mi, scene, integrator, spp, range(passes))
    mask = None
    if row.get("mask"):
        mask = specular_mask(mi, scene, size)
        mean, variance = mean * mask, variance * mask
        write_exr(target.with_suffix(".mask.exr"), mask)
    write_exr(target, mean)
    write_exr(target.with_suffix(".var.exr"), variance)
    command = f"python3 tools/references/make.py {name}"
    pixels = mean.shape[0] * mean.shape[1]
    text = f"# Written by {command}; edit tools/references/scenes.toml instead.\n"
    text += f"name = {toml(name)}\nscene = {toml(row['scene'])}\nsize = {toml(size)}\n"
    text += table("reference", {
        "command": command,
        "versions": {**PACKAGES, "drjit": drjit.__version__, "python": sys.version.split()[0]},
        "variant": variant,
        "integrator": row["integrator"],
        "parameters": keep,
        "why": row["why"],
        "filter": "box",
        "spp": passes * spp,
        "passes": passes,
        "seeds": f"0..{passes}",
        "rmse": float(np.sqrt(variance.mean())),
        "relative_rmse": float(np.sqrt(variance.mean()) / mean.mean()),
        "mean": [float(v) for v in mean.reshape(pixels, 3).mean(0)],
        "mask": bool(row.get("mask")),
    })
    if "bias_check" in row:
        text += table("bias_check", bias_check(mi, row))
    for file in files_of(scene_file):
        text += "\n[[files]]\n" + f"path = {toml(str(file.relative_to(ROOT)))}\n"
        text += f"sha256 = {toml(hashlib.sha256(file.read_bytes()).hexdigest())}\n"
    text += limits_text(mi, scene, row, integrator, limits.Measured(target, mean, variance, passes * spp), mask)
    manifest.write_text(text)
    print(f"{name}: {size[0]}x{size[1]}, {passes * spp} spp, noise {np.sqrt(variance.mean()) / mean.mean():.3%},"
          f" {time.time() - started:.0f} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--venv", type=Path, default=ROOT / "target" / "mitsuba-venv", help="virtual environment")
    parser.add_argument("--limits", action="store_true", help="keep the references and compute their limits again")
    parser.add_argument("--list", action="store_true", help="list the names and exit")
    parser.add_argument("names", nargs="*", metavar="NAME")
    args = parser.parse_args()
    rows = tomllib.loads(CONFIG.read_text())["reference"]
    if args.list:
        print("\n".join(r["name"] for r in rows))
        return
    unknown = set(args.names) - {r["name"] for r in rows}
    if unknown:
        sys.exit(f"scenes.toml has no {', '.join(sorted(unknown))}")
    inside_venv(args.venv)
    chosen = [row for row in rows if not args.names or row["name"] in args.names]
    import mitsuba as mi

    variant = choose_variant(mi)
    (ROOT / "reference").mkdir(exist_ok=True)
    for row in chosen:
        renew_limits(mi, row) if args.limits else make(mi, variant, row)


if __name__ == "__main__":
    main()
