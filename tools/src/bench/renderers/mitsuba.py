"""Renders a scene with Mitsuba 3 and writes the cost as JSON.

The scene's integrator, film size and reconstruction filter are replaced; everything else is kept.
What is measured is the render alone: loading and the compilation of kernels come before.
With "check" in the job nothing is rendered: the script only tests whether the variant can be used.
"""
import glob
import json
import os
import resource
import sys
import time
import xml.etree.ElementTree as ET

job = json.loads(sys.argv[1])

if job["variant"].startswith("llvm") and "DRJIT_LIBLLVM_PATH" not in os.environ:
    # Debian's package has no link without a version, which is what drjit looks for.
    found = glob.glob("/usr/lib/*/libLLVM*.so*") + glob.glob("/usr/lib/llvm-*/lib/libLLVM*.so*")
    if found:
        os.environ["DRJIT_LIBLLVM_PATH"] = sorted(found)[-1]

import mitsuba as mi

mi.set_variant(job["variant"])
if job.get("check"):
    mi.Float(1.0) + mi.Float(2.0)
    sys.exit()
folder = os.path.dirname(os.path.abspath(job["scene"]))
try:
    mi.file_resolver().append(folder)
except AttributeError:
    mi.Thread.thread().file_resolver().append(folder)

root = ET.parse(job["scene"]).getroot()
depth, hide = -1, "false"
defaults = {d.get("name"): d.get("value") for d in root.findall("default")}
for node in root.findall("integrator"):
    for value in node.iter("integer"):
        if value.get("name") in ("max_depth", "maxDepth"):
            text = value.get("value")
            depth = int(defaults.get(text[1:], "-1") if text.startswith("$") else text)
    for value in node.iter("boolean"):
        if value.get("name") in ("hide_emitters", "hideEmitters"):
            hide = value.get("value")
    root.remove(node)
depth = job["max_depth"] if job["max_depth"] is not None else depth
for film in root.iter("film"):
    for node in list(film):
        if node.tag == "rfilter" or node.get("name") in ("width", "height"):
            film.remove(node)
    for name, value in zip(("width", "height"), job["size"]):
        ET.SubElement(film, "integer", name=name, value=str(value))
    ET.SubElement(film, "rfilter", type="box")
integrator = ET.SubElement(root, "integrator", type=job["integrator"])
ET.SubElement(integrator, "integer", name="max_depth", value=str(depth))
ET.SubElement(integrator, "boolean", name="hide_emitters", value=hide)

scene = mi.load_string(ET.tostring(root, encoding="unicode"))


def render(spp, seed):
    cpu, wall = time.process_time(), time.perf_counter()
    image = mi.TensorXf(mi.render(scene, spp=spp, seed=seed))
    image.numpy()
    return image, time.perf_counter() - wall, time.process_time() - cpu


spp = job["spp"]
render(min(spp, 2), 1 << 20)  # compiles kernels: one for a single sample, one for more
image, wall, cpu = render(spp, job["seed"])
mi.Bitmap(image).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False).write(job["image"])
with open(job["stats"], "w") as out:
    json.dump({
        "seconds": wall,
        "cpu_seconds": cpu,
        "peak_memory_bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
        "passes": spp,
        "version": mi.__version__,
    }, out)
