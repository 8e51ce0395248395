"""Renders a scene that tyndall exported in Mitsuba 3, a ladder of samples, and times it.

    python3 mitsuba_job.py JOB.json

(a copy: under its own name it would be found instead of the package mitsuba)

Speaks one JSON object a line on standard output: {"event": "picture", ...} with a .npy file each,
{"event": "error", "what": ...}, {"event": "done"}. Conventions: see export.rs.
"""
import glob, json, os, resource, sys, time


def say(**event):
    print(json.dumps(event), flush=True)


def fail(what):
    say(event="error", what=what)
    sys.exit(0)


def find_llvm():
    """LLVM 14 is refused by drjit and 15 aborts the process at its first kernel: 19 and newer only."""
    if os.environ.get("DRJIT_LIBLLVM_PATH"):
        return
    for version in ("19", "20", "21"):
        for pattern in ("/usr/lib/*/libLLVM*%s*", "/usr/lib/llvm-%s/lib/libLLVM*"):
            found = sorted(path for path in glob.glob(pattern % version) if ".so" in path)
            if found:
                os.environ["DRJIT_LIBLLVM_PATH"] = found[0]
                return
    fail("no LLVM 19 or newer found: install libllvm19 or set DRJIT_LIBLLVM_PATH")


with open(sys.argv[1]) as file:
    job = json.load(file)
FOLDER = os.path.dirname(os.path.abspath(sys.argv[1]))
if job["variant"].startswith("llvm"):
    find_llvm()
try:
    import numpy as np
except ImportError:
    fail("the Python package numpy is missing: pip install numpy")
try:
    import mitsuba as mi
except ImportError:
    fail("the Python package mitsuba is missing: pip install mitsuba")
try:
    mi.set_variant(job["variant"])
except Exception as error:  # noqa: BLE001: whatever it is, it is said
    fail("variant %s: %s" % (job["variant"], error))
mi.set_log_level(mi.LogLevel.Error)
T = mi.ScalarTransform4f
import surfaces  # noqa: E402: needs the variant


def rgb(values):
    return {"type": "rgb", "value": [float(value) for value in values]}


def grey(values):
    return max(values) - min(values) <= 1e-7 * max(max(values), 1e-30)


def volume(values):
    """A constant of one or three channels."""
    if grey(values):
        return {"type": "constvolume", "value": float(values[0])}
    return {"type": "constvolume", "value": rgb(values)}


def medium(entry):
    sigma_t = entry["sigma_t"]
    common = {
        "albedo": volume(entry["albedo"]),
        "phase": entry["phase"],
        "has_spectral_extinction": not grey(sigma_t),
    }
    grid = entry.get("grid")
    if grid is None:
        return {"type": "homogeneous", "sigma_t": volume(sigma_t), **common}
    density = np.fromfile(os.path.join(FOLDER, grid["file"]), "<f4").reshape(grid["shape"])
    if grey(sigma_t):
        data, scale = density[..., None], float(sigma_t[0])
    else:
        scale = float(max(sigma_t))
        data = density[..., None] * (np.array(sigma_t, "f4") / scale)
    low, high = np.array(grid["low"]), np.array(grid["high"])
    return {
        "type": "heterogeneous",
        "scale": scale,
        "sigma_t": {
            "type": "gridvolume",
            "grid": mi.VolumeGrid(np.ascontiguousarray(data, dtype=np.float32)),
            "raw": True,
            "filter_type": "trilinear",
            "wrap_mode": "clamp",
            "to_world": T().translate(list(low)).scale(list(high - low)),
        },
        **common,
    }


def spot(light):
    """Mitsuba's falloff is linear in the angle, glTF's is the square of a ramp in the cosine: a picture of
    that, projected, stands in front of a cone of even light."""
    inner, outer = light["inner_angle"], light["outer_angle"]
    side = 2048 if outer < 1.4 else 4096
    at = ((np.arange(side) + 0.5) / side * 2 - 1) * np.tan(outer)
    cosine = 1 / np.sqrt(1 + at[:, None] ** 2 + at[None, :] ** 2)
    ramp = (cosine - np.cos(outer)) / (np.cos(inner) - np.cos(outer))
    position, axis = np.array(light["position"]), np.array(light["direction"])
    up = [0, 0, 1] if abs(axis[1]) > 0.9 else [0, 1, 0]
    return {
        "type": "spot",
        "intensity": rgb(light["intensity"]),
        "cutoff_angle": float(np.degrees(outer)),
        "beam_width": float(np.degrees(outer)) * (1 - 1e-4),
        "texture": surfaces.bitmap(np.clip(ramp, 0, 1)[..., None] ** 2, ("clamp", "clamp")),
        "to_world": T().look_at(origin=list(position), target=list(position + axis), up=up),
    }


def sky(light):
    """Tyndall's rows are the middles of their rings, Mitsuba's run from pole to pole: a finer map that has
    all lines of both lattices is the same bilinear function."""
    width, height = light["width"], light["height"]
    pixels = np.fromfile(os.path.join(FOLDER, light["file"]), "<f4").reshape(height, width, 3)
    pixels = pixels.astype(np.float64) * light["radiance"]
    rows = np.clip(np.arange(2 * height + 1) / 2 - 0.5, 0, height - 1)
    low = np.clip(rows.astype(int), 0, max(height - 2, 0))
    f = (rows - low)[:, None, None]
    fine = pixels[low] * (1 - f) + pixels[np.minimum(low + 1, height - 1)] * f
    columns = (np.arange(3 * width) + 0.5) / 3 - 0.5
    low = np.floor(columns).astype(int)
    f = (columns - low)[None, :, None]
    fine = fine[:, low % width] * (1 - f) + fine[:, (low + 1) % width] * f
    # The centre column of Mitsuba's maps looks along +Z.
    turn = T().rotate([0, 1, 0], float(np.degrees(light["rotation"])) + 180)
    return {"type": "envmap", "bitmap": mi.Bitmap(fine.astype(np.float32)), "to_world": turn}


def build():
    scene = {"type": "scene"}
    for i, entry in enumerate(job["media"]):
        scene["medium%d" % i] = medium(entry)
        if entry["box"] is not None:
            low, high = np.array(entry["box"][0]), np.array(entry["box"][1])
            scene["medium%d_box" % i] = {
                "type": "cube",
                "to_world": T().translate(list((low + high) / 2)).scale(list((high - low) / 2)),
                "bsdf": {"type": "null"},
                "interior": {"type": "ref", "id": "medium%d" % i},
            }
    scene.update(surfaces.build(job, FOLDER))
    for i, light in enumerate(job["lights"]):
        if light["kind"] == "point":
            plugin = {
                "type": "point",
                "position": light["position"],
                "intensity": rgb(light["intensity"]),
            }
        elif light["kind"] == "directional":
            plugin = {
                "type": "directional",
                "direction": light["direction"],
                "irradiance": rgb(light["irradiance"]),
            }
        elif light["kind"] == "spot":
            plugin = spot(light)
        elif light["kind"] == "environment":
            plugin = sky(light)
        else:
            plugin = {"type": "constant", "radiance": rgb(light["radiance"])}
        scene["light%d" % i] = plugin
    camera = job["camera"]
    sensor = {
        "type": "perspective",
        "fov": camera["vertical_fov_degrees"],
        "fov_axis": "y",
        "near_clip": 1e-3,
        "far_clip": 1e5,
        "to_world": T().look_at(
            origin=camera["position"], target=camera["target"], up=camera["up"]
        ),
        "film": {
            "type": "hdrfilm",
            "width": job["width"],
            "height": job["height"],
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "independent"},
    }
    if camera["medium"] is not None:
        sensor["medium"] = {"type": "ref", "id": "medium%d" % camera["medium"]}
    scene["sensor"] = sensor
    return mi.load_dict(scene)


def clock():
    return time.perf_counter(), time.process_time()


def picture(technique, claim, spp, image, seconds, cpu, version):
    name = "%s_%s_%d.npy" % (technique.replace("+", "_"), claim, spp)
    path = os.path.join(FOLDER, name)
    np.save(path, np.ascontiguousarray(image, dtype=np.float32))
    say(
        event="picture",
        technique=technique,
        claim=claim,
        samples=spp,
        file=path,
        seconds=seconds,
        cpu_seconds=cpu,
        seed=job["seed"],
        version=version,
        resident_bytes=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
    )


def denoiser():
    """A function from image, and albedo and normal if they guide it, to image; or None."""
    if not job["denoise"]:
        return None
    try:
        import pyoidn
    except ImportError:
        say(event="remark", what="pyoidn is missing: pictures are not denoised")
        return None
    try:
        return make_denoiser(pyoidn)
    except Exception as error:  # noqa: BLE001
        say(event="remark", what="pyoidn: %s: pictures are not denoised" % error)
        return None


def make_denoiser(oidn):
    device = oidn.Device()
    device.commit()

    def run(image, guides=()):
        color = np.ascontiguousarray(image, dtype=np.float32)
        result = np.zeros_like(color)
        filter = oidn.Filter(device, oidn.OIDN_FILTER_TYPE_RT)
        images = [("color", color), ("output", result), *guides]
        for name, pixels in images:
            filter.set_image(name, pixels, oidn.OIDN_FORMAT_FLOAT3, pixels.shape[1], pixels.shape[0])
        filter.set_bool("hdr", True)
        filter.commit()
        filter.execute()
        return result

    probe = run(np.full((16, 16, 3), 0.5, dtype=np.float32))
    if not np.isfinite(probe).all() or abs(float(probe.mean()) - 0.5) > 0.1:
        raise RuntimeError("a grey picture does not stay grey")
    return run


def guides(scene, spp):
    """Albedo and normal of what the camera sees through the media."""
    aov = mi.load_dict({"type": "aov", "aovs": "albedo:albedo,normal:sh_normal"})
    image = np.array(mi.render(scene, integrator=aov, spp=spp, seed=job["seed"]), dtype=np.float32)
    return [
        ("albedo", np.ascontiguousarray(np.clip(image[..., 0:3], 0, 1))),
        ("normal", np.ascontiguousarray(image[..., 3:6])),
    ]


def guided(denoise, scene):
    """Whether this version of Mitsuba gives what guides the denoiser."""
    if denoise is None:
        return False
    try:
        guides(scene, 1)
        return True
    except Exception as error:  # noqa: BLE001
        say(event="remark", what="no albedo and normals for the denoiser: %s" % error)
        return False


def main():
    scene = build()
    denoise = denoiser()
    has_guides = guided(denoise, scene)
    version = "Mitsuba %s, %s" % (mi.__version__, job["variant"])
    depths = {"whole": -1, "one_scattering": 2}
    for claim in job["claims"]:
        integrator = mi.load_dict({"type": "volpath", "max_depth": depths[claim], "rr_depth": 5})
        # Kernels are compiled at the first call; how many samples it takes makes no difference.
        np.array(mi.render(scene, integrator=integrator, spp=1, seed=job["seed"] + 1))
        for spp in job["samples"]:
            wall, cpu = clock()
            image = np.array(mi.render(scene, integrator=integrator, spp=spp, seed=job["seed"]))
            seconds, cpu_seconds = (after - before for after, before in zip(clock(), (wall, cpu)))
            picture("mitsuba_volpath", claim, spp, image, seconds, cpu_seconds, version)
            if denoise is not None:
                wall, cpu = clock()
                clean = denoise(image)
                more = [after - before for after, before in zip(clock(), (wall, cpu))]
                picture(
                    "mitsuba_volpath+oidn", claim, spp, clean,
                    seconds + more[0], cpu_seconds + more[1], version,
                )
            if has_guides:
                wall, cpu = clock()
                clean = denoise(image, guides(scene, spp))
                more = [after - before for after, before in zip(clock(), (wall, cpu))]
                picture(
                    "mitsuba_volpath+oidn_guided", claim, spp, clean,
                    seconds + more[0], cpu_seconds + more[1], version,
                )
            # The next rung takes about four times as long.
            if 4 * seconds > job["row_seconds"]:
                break
    say(event="done")


try:
    main()
except Exception as error:  # noqa: BLE001
    fail("%s: %s" % (type(error).__name__, error))
