"""Makes everything in this folder: textures, scenes and the truths that Mitsuba renders of them.

Mitsuba 3.9.1 (drjit 1.5.0, numpy 2), variant `llvm_ad_rgb` on LLVM 19, integrator `volpath`:

    DRJIT_LIBLLVM_PATH=<libLLVM-19.so> python make.py [SCENE ...]

Without names all scenes are written and rendered, about ten minutes on two cores. A scene is
described once, below, and written twice: as JSON and glTF, which Tyndall loads as a user's, and as a
Mitsuba scene that shares no code and no file with it. Texture pixels go to Mitsuba as decoded
numbers, so that its own decoding and 16-bit storage play no part.
"""

import base64
import json
import os
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
WIDTH, HEIGHT = 64, 48
# Independent seeds, and samples a pixel of each.
SEEDS, SAMPLES = 32, 128
SIDE = 64
FOG = {"sigma_t": 0.12, "albedo": 0.8, "g": 0.4, "min": [-3, -0.5, -3], "max": [3, 3.5, 3]}


# Textures: 8 bits, row 0 at the top.


def texel_grid():
    x = (np.arange(SIDE) + 0.5) / SIDE
    return np.meshgrid(x, x)


def base_color_texture():
    """Dark red to blue from left to right, so that opposite edges differ; squares and a dot."""
    u, v = texel_grid()
    checks = ((u * 4).astype(int) + (v * 4).astype(int)) % 2
    dot = (u - 0.3) ** 2 + (v - 0.25) ** 2 < 0.02
    r = 0.85 - 0.7 * u + 0.1 * checks
    g = 0.25 + 0.5 * v * checks
    b = 0.1 + 0.75 * u
    rgb = np.stack([r, g, b], -1)
    rgb[dot] = [0.95, 0.95, 0.2]
    return to_bytes(rgb)


def metallic_roughness_texture():
    """Green: roughness 0.3 to 1 from the top to the bottom; blue: metalness, 0 and 1 in stripes."""
    u, v = texel_grid()
    metallic = 0.5 + 0.5 * np.clip(3 * np.sin(2 * np.pi * 2 * u), -1, 1)
    return to_bytes(np.stack([np.zeros_like(u), 0.3 + 0.7 * v, metallic], -1))


def normal_texture():
    """Waves, steeper along u than along v, of different lengths: no axis can be mistaken."""
    u, v = texel_grid()
    x = 0.35 * np.sin(2 * np.pi * u) + 0.1
    y = 0.2 * np.cos(2 * np.pi * 2 * v) - 0.08
    z = np.sqrt(1 - x * x - y * y)
    return to_bytes(0.5 + 0.5 * np.stack([x, y, z], -1))


def cut_out_texture():
    """Base colour, with an alpha whose contour at ½ is an unsymmetrical pattern of holes."""
    u, v = texel_grid()
    alpha = 0.5 + 0.35 * np.sin(2 * np.pi * (2 * u + 0.1)) + 0.3 * np.cos(2 * np.pi * (v + 0.4 * u))
    rgb = np.stack([0.3 + 0.5 * u, 0.7 - 0.4 * v, 0.4 + 0 * u], -1)
    return to_bytes(np.concatenate([rgb, alpha[..., None]], -1))


def to_bytes(values):
    return np.round(np.clip(values, 0, 1) * 255).astype(np.uint8)


TEXTURES = {
    "base_color": base_color_texture(),
    "metallic_roughness": metallic_roughness_texture(),
    "normal": normal_texture(),
    "cut_out": cut_out_texture(),
}


def sky_map():
    """Radiance of 32 × 16 directions: a sky, a ground, a small sun off every axis."""
    width, height = 32, 16
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    up = np.cos(np.pi * y)[..., None]
    sky = np.array([0.3, 0.5, 0.9]) * (0.4 + 0.6 * np.clip(up, 0, 1))
    ground = np.array([0.35, 0.25, 0.15]) * (1 + 0.5 * np.sin(2 * np.pi * x))[..., None]
    pixels = np.where(up > 0, sky, ground)
    pixels[4, 20] = [150, 120, 80]
    pixels[4, 21] = [60, 50, 40]
    pixels[9, 5] = [1, 8, 2]
    return pixels.astype(np.float32)


# Scenes. A quad is corner, edge_u, edge_v with its front along edge_u × edge_v; its upper left corner
# in the image, texture coordinate (0, 0) before `uv`, is corner + edge_v.


def quad(corner, edge_u, edge_v, uv=((0, 0), (1, 1)), **material):
    """`uv`: coordinates at the upper left and the lower right corner."""
    return {"corner": corner, "edge_u": edge_u, "edge_v": edge_v, "uv": uv, **material}


def floor(**material):
    return quad([-2, 0, 2], [4, 0, 0], [0, 0, -4], **material)


def wall(**material):
    return quad([-2, 0, -2], [4, 0, 0], [0, 3, 0], **material)


def lamp(z):
    """Looks down; its middle is at z."""
    return quad([-0.6, 2.9, z - 0.6], [1.2, 0, 0], [0, 0, 1.2], color=[0, 0, 0], emission=[14, 12, 9])


FRONT = {"position": [0.3, 1.7, 4.6], "target": [0, 0.9, -0.3], "fov": 42}
ABOVE = {"position": [0.4, 4.4, 2.6], "target": [0, 0, 0], "fov": 42}

SCENES = {
    "base_color": {
        "camera": FRONT,
        "quads": [
            floor(base="base_color", wrap="repeat", uv=((-0.3, 0.2), (2.0, 2.4))),
            wall(base="base_color", wrap="mirror", uv=((-0.6, -1.3), (1.9, 1.1)), color=[0.9, 0.8, 1.0]),
            quad([-1.6, 0.2, 0.2], [1.3, 0, 0.5], [0, 1.4, 0], base="base_color", wrap="clamp",
                 uv=((-0.7, -0.4), (1.5, 1.6))),
            quad([0.6, 0.1, 0.9], [1.1, 0, -0.5], [0, 1.0, -0.4], base="base_color", wrap="repeat",
                 transform={"offset": [0.2, -0.1], "scale": [1.5, 0.75]}),
            lamp(1.5),
        ],
    },
    "metallic_roughness": {
        "camera": FRONT,
        "quads": [
            floor(base="base_color", surface="metallic_roughness", roughness=0.9, metallic=1.0, wrap="repeat"),
            wall(color=[0.95, 0.7, 0.4], roughness=0.5, metallic=1.0),
            quad([-1.6, 0.2, 0.2], [1.3, 0, 0.5], [0, 1.4, 0], base="base_color", wrap="repeat", roughness=0.45,
                 metallic=0.0),
            quad([0.6, 0.1, 0.9], [1.1, 0, -0.5], [0, 1.0, -0.4], color=[0.8, 0.8, 0.8],
                 surface="metallic_roughness", roughness=1.0, metallic=0.6, wrap="repeat"),
            lamp(1.5),
        ],
    },
    # One scattering at most, from above: a mapped normal never looks away from the viewer, where
    # programs differ by design.
    "normal_map": {
        "camera": ABOVE,
        "max_scatterings": 1,
        "quads": [
            quad([-2, 0, 0], [1.9, 0, 0], [0, 0, -1.9], normal="normal", wrap="repeat"),
            # Mirrored: u runs against the image.
            quad([0.1, 0, 0], [1.9, 0, 0], [0, 0, -1.9], normal="normal", wrap="repeat", uv=((1, 0), (0, 1))),
            # A quarter turn, scaled, coloured.
            quad([-0.1, 0, 2], [0, 0, -1.9], [-1.9, 0, 0], normal="normal", wrap="repeat", normal_scale=0.6,
                 base="base_color"),
            quad([0.1, 0, 2], [1.9, 0, 0], [0, 0, -1.9], normal="normal", wrap="repeat", uv=((0, 0), (2, 1)),
                 color=[0.9, 0.8, 0.5], roughness=0.5, metallic=0.8),
            lamp(-0.6),
        ],
    },
    # As normal_map: one scattering, from above.
    "placements": {
        "camera": ABOVE,
        "in_fog": False,
        "max_scatterings": 1,
        "quads": [
            quad([-2, 0, 0], [1.9, 0, 0], [0, 0, -1.9], base="base_color", wrap="repeat",
                 transform={"offset": [0.3, -0.2], "scale": [1.4, 0.8], "rotation": 0.7}),
            # On the second set; the first would show it mirrored and halved.
            quad([0.1, 0, 0], [1.9, 0, 0], [0, 0, -1.9], base="base_color", wrap="repeat", second_set=True),
            quad([-2, 0, 2], [1.9, 0, 0], [0, 0, -1.9], normal="normal", wrap="repeat",
                 transform={"offset": [0.1, 0.4], "scale": [1.5, 1.0], "rotation": 0.9}),
            quad([0.1, 0, 2], [1.9, 0, 0], [0, 0, -1.9], normal="normal", wrap="repeat", second_set=True,
                 base="base_color", transform={"scale": [1.0, 1.5], "rotation": -0.4}),
            lamp(-0.6),
        ],
    },
    "cut_out": {
        "camera": FRONT,
        "quads": [
            floor(color=[0.7, 0.7, 0.7]),
            wall(color=[0.6, 0.7, 0.6]),
            # Over the floor, under the lamp; in view; and one that shines.
            quad([-1.3, 1.9, 1.6], [2.6, 0, 0], [0, 0, -2.0], base="cut_out", wrap="repeat", cutoff=0.5),
            quad([-1.6, 0.2, 0.4], [1.3, 0, 0.5], [0, 1.4, 0], base="cut_out", wrap="repeat", cutoff=0.35,
                 uv=((0.2, 0), (1.7, 1))),
            quad([0.5, 0.15, 0.7], [1.2, 0, -0.3], [0, 1.1, 0], base="cut_out", wrap="repeat", cutoff=0.6,
                 emission=[1.0, 2.0, 3.0], color=[0.5, 0.5, 0.5], single_sided=True),
            lamp(1.5),
        ],
    },
    "environment": {
        "camera": FRONT,
        "sky": {"radiance": [1.0, 0.9, 0.8], "rotation_degrees": 37.0},
        "quads": [
            floor(color=[0.7, 0.6, 0.5]),
            quad([-1.6, 0.2, 0.2], [1.3, 0, 0.5], [0, 1.4, 0], base="base_color", wrap="repeat"),
            quad([0.4, 0.1, 0.6], [1.3, 0, -0.6], [0, 1.0, -0.6], color=[0.9, 0.8, 0.6], roughness=0.5, metallic=1.0),
        ],
    },
}


def corners(q):
    """Positions and texture coordinates: lower left, lower right, upper right, upper left."""
    p, a, b = (np.array(q[k], float) for k in ("corner", "edge_u", "edge_v"))
    (u0, v0), (u1, v1) = q["uv"]
    positions = np.array([p, p + a, p + a + b, p + b])
    texcoords = np.array([[u0, v1], [u1, v1], [u1, v0], [u0, v0]], float)
    return positions, texcoords


def outline(q):
    """Corners, indices of the two triangles, and the normal."""
    positions, texcoords = corners(q)
    normal = np.cross(np.array(q["edge_u"], float), np.array(q["edge_v"], float))
    return positions, texcoords, [0, 1, 2, 0, 2, 3], normal / np.linalg.norm(normal)


# Tyndall's side: glTF and JSON.

WRAPS = {"repeat": 10497, "mirror": 33648, "clamp": 33071}


def write_gltf(name, scene):
    blob, views, accessors, meshes, materials = b"", [], [], [], []
    images, samplers, textures = [], [], []

    def index(items, item):
        if item not in items:
            items.append(item)
        return items.index(item)

    def accessor(values, component, kind):
        nonlocal blob
        values = np.ascontiguousarray(values)
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": values.nbytes})
        entry = {"bufferView": len(views) - 1, "componentType": component, "count": len(values), "type": kind}
        if kind == "VEC3":
            entry |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        accessors.append(entry)
        blob += values.tobytes()
        return len(accessors) - 1

    def texture(q, image):
        sampler = index(samplers, {"magFilter": 9729, "minFilter": 9729, "wrapS": WRAPS[q["wrap"]], "wrapT": WRAPS[q["wrap"]]})
        source = index(images, {"uri": f"{image}.png"})
        info = {"index": index(textures, {"sampler": sampler, "source": source})}
        if "transform" in q:
            info["extensions"] = {"KHR_texture_transform": q["transform"]}
        if q.get("second_set"):
            info["texCoord"] = 1
        return info

    for q in scene["quads"]:
        positions, texcoords, order, normal = outline(q)
        pbr = {
            "baseColorFactor": [*q.get("color", [1, 1, 1]), 1.0],
            "metallicFactor": q.get("metallic", 0.0),
            "roughnessFactor": q.get("roughness", 1.0),
        }
        emits = "emission" in q
        material = {"pbrMetallicRoughness": pbr, "doubleSided": not (emits or q.get("single_sided", False))}
        if "base" in q:
            pbr["baseColorTexture"] = texture(q, q["base"])
        if "surface" in q:
            pbr["metallicRoughnessTexture"] = texture(q, q["surface"])
        if "normal" in q:
            material["normalTexture"] = texture(q, q["normal"]) | {"scale": q.get("normal_scale", 1.0)}
        if "cutoff" in q:
            material |= {"alphaMode": "MASK", "alphaCutoff": q["cutoff"]}
        if emits:
            strength = max(q["emission"])
            material["emissiveFactor"] = [e / strength for e in q["emission"]]
            material["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
        materials.append(material)
        primitive = {
            "attributes": {
                "POSITION": accessor(positions.astype(np.float32), 5126, "VEC3"),
                "NORMAL": accessor(np.tile(normal, (4, 1)).astype(np.float32), 5126, "VEC3"),
                "TEXCOORD_0": accessor(texcoords.astype(np.float32), 5126, "VEC2"),
            },
            "indices": accessor(np.array(order, np.uint32), 5125, "SCALAR"),
            "material": len(materials) - 1,
        }
        if q.get("second_set"):
            attributes = primitive["attributes"]
            attributes["TEXCOORD_1"] = attributes["TEXCOORD_0"]
            decoy = (texcoords[:, ::-1] * 0.5).astype(np.float32)
            attributes["TEXCOORD_0"] = accessor(decoy, 5126, "VEC2")
        meshes.append({"primitives": [primitive]})
    document = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_emissive_strength", "KHR_texture_transform"],
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"mesh": i} for i in range(len(meshes))],
        "meshes": meshes,
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob), "uri": "data:application/octet-stream;base64," + base64.b64encode(blob).decode()}],
    }
    for key, values in [("images", images), ("samplers", samplers), ("textures", textures)]:
        if values:
            document[key] = values
    with open(f"{HERE}/{name}.gltf", "w") as file:
        json.dump(document, file, indent=1)
        file.write("\n")


def write_json(name, scene, fog):
    camera = scene["camera"]
    document = {
        "version": 1,
        "name": f"Truth: {name}" + (" in fog" if fog else ""),
        "camera": {"position": camera["position"], "target": camera["target"], "vertical_fov_degrees": camera["fov"]},
        "geometry": [{"kind": "gltf", "path": f"{name}.gltf"}],
        "render": {"technique": "reference", "width": WIDTH, "height": HEIGHT, "samples": 64},
    }
    if "max_scatterings" in scene:
        document["render"]["reference"] = {"max_scatterings": scene["max_scatterings"]}
    if "sky" in scene:
        document["lights"] = [{"kind": "environment", "map": "sky.exr", **scene["sky"]}]
    if fog:
        document["media"] = [{
            "kind": "homogeneous", "sigma_t": FOG["sigma_t"], "albedo": FOG["albedo"], "g": FOG["g"],
            "bounds": {"min": FOG["min"], "max": FOG["max"]},
        }]
    with open(f"{HERE}/{name}{'_fog' if fog else ''}.json", "w") as file:
        json.dump(document, file, indent=2)
        file.write("\n")


# Mitsuba's side.


def decode_srgb(values):
    x = values.astype(np.float64) / 255
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def bitmap(values, wrap="repeat", filter_type="bilinear"):
    """A texture of linear numbers; Mitsuba's row 0 is at v = 0, as glTF's."""
    tensor = mi.TensorXf(np.ascontiguousarray(values, dtype=np.float32))
    return {"type": "bitmap", "data": tensor, "raw": True, "wrap_mode": wrap, "filter_type": filter_type, "format": "variant"}


def constant(rgb):
    return {"type": "rgb", "value": [float(c) for c in rgb]}


def raw(rgb):
    """A constant that is no reflectance."""
    return bitmap(np.full((2, 2, 3), rgb, np.float32))


class MetallicRoughness(mi.BSDF):
    """glTF 2.0, appendix B: (1 − F)·diffuse/π + F·D·V with Schlick's F at half vector, GGX and the
    height-correlated Smith term. None of Mitsuba's own has this sum and this Smith term."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.base = props["base"]
        self.surface = props["surface"]
        flags = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
        self.m_components = [flags]
        self.m_flags = flags

    def parameters(self, si, active):
        surface = self.surface.eval_3(si, active)
        base = mi.Color3f(self.base.eval_3(si, active))
        alpha = dr.maximum(surface.y * surface.y, 1e-3)
        return base * (1 - surface.z), alpha, 0.04 * (1 - surface.z) + base * surface.z

    def value_and_density(self, si, wo, active):
        diffuse, alpha, f0 = self.parameters(si, active)
        i, o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
        valid = active & (i > 0) & (o > 0)
        h = dr.normalize(si.wi + wo)
        fresnel = f0 + (1 - f0) * (1 - dr.clip(dr.dot(wo, h), 0, 1)) ** 5

        def smith_lambda(cosine):
            tan2 = 1 / (cosine * cosine) - 1
            return 0.5 * (dr.sqrt(1 + alpha * alpha * tan2) - 1)

        distribution = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)
        specular = distribution.eval(h) / (1 + smith_lambda(i) + smith_lambda(o)) / (4 * i * o)
        value = ((1 - fresnel) * diffuse * dr.inv_pi + fresnel * specular) * o
        density = 0.5 * o * dr.inv_pi + 0.5 * distribution.pdf(si.wi, h) / (4 * dr.dot(wo, h))
        return dr.select(valid, value, 0), dr.select(valid, density, 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        _, alpha, _ = self.parameters(si, active)
        distribution = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)
        m, _ = distribution.sample(si.wi, sample2)
        wo = dr.select(sample1 < 0.5, mi.warp.square_to_cosine_hemisphere(sample2), mi.reflect(si.wi, m))
        value, density = self.value_and_density(si, wo, active)
        valid = density > 0
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo = wo
        bs.pdf = density
        bs.eta = 1.0
        bs.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
        bs.sampled_component = mi.UInt32(0)
        return bs, dr.select(valid, value / density, 0)

    def eval(self, ctx, si, wo, active=True):
        return self.value_and_density(si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.value_and_density(si, wo, active)[1]

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.value_and_density(si, wo, active)

    def traverse(self, callback):
        pass

    def to_string(self):
        return "MetallicRoughness[]"


mi.register_bsdf("metallic_roughness", MetallicRoughness)


def resolved(alpha, side=4096):
    """Bilinear interpolation of a repeating texture at side² places."""
    place = (np.arange(side) + 0.5) / side * SIDE - 0.5
    low = np.floor(place).astype(int)
    f = place - low
    low, high = low % SIDE, (low + 1) % SIDE
    rows = alpha[low] * (1 - f)[:, None] + alpha[high] * f[:, None]
    return rows[:, low] * (1 - f) + rows[:, high] * f


def placed(texcoords, q):
    """KHR_texture_transform: scale, then rotation counter-clockwise in the image, then offset. So its example
    is the image's lower left quadrant: offset (0, 1), rotation 90°, scale ½ take the unit square there."""
    t = q.get("transform", {})
    sin, cos = np.sin(t.get("rotation", 0.0)), np.cos(t.get("rotation", 0.0))
    rotation = np.array([[cos, sin], [-sin, cos]])
    return (texcoords * t.get("scale", [1, 1])) @ rotation.T + t.get("offset", [0, 0])


def mitsuba_bsdf(q):
    color = np.array(q.get("color", [1, 1, 1]), float)
    wrap = q.get("wrap", "repeat")
    if "base" in q:
        texels = decode_srgb(TEXTURES[q["base"]][..., :3]) * color
        base = bitmap(texels, wrap)
    else:
        base = raw(color)
    roughness, metallic = q.get("roughness", 1.0), q.get("metallic", 0.0)
    if "surface" in q:
        texels = TEXTURES[q["surface"]] / 255.0 * [1, roughness, metallic]
        bsdf = {"type": "metallic_roughness", "base": base, "surface": bitmap(texels, wrap)}
    elif metallic > 0 or roughness < 1:
        bsdf = {"type": "metallic_roughness", "base": base, "surface": raw([0, roughness, metallic])}
    else:
        bsdf = {"type": "diffuse", "reflectance": base}
    if "normal" in q:
        scale = q.get("normal_scale", 1.0)
        texels = (TEXTURES[q["normal"]] / 255.0 * 2 - 1) * [scale, scale, 1]
        positions, texcoords, order, normal = outline(q)
        texcoords = placed(texcoords, q)
        a, b, c = order[:3]
        d1, d2 = texcoords[b] - texcoords[a], texcoords[c] - texcoords[a]
        # glTF's bitangent points up in the image, Mitsuba's is normal × tangent: where the image is
        # seen mirrored the two are opposite.
        if d1[0] * d2[1] - d2[0] * d1[1] > 0:
            texels = texels * [1, -1, 1]
        bsdf = {"type": "normalmap", "normalmap": bitmap(0.5 + 0.5 * texels, wrap), "bsdf": bsdf,
                "flip_invalid_normals": False, "use_shadowing_function": False}
    else:
        bsdf = {"type": "twosided", "bsdf": bsdf}
    if "cutoff" in q:
        solid = resolved(TEXTURES[q["base"]][..., 3] / 255.0) >= q["cutoff"]
        bsdf = {"type": "mask", "opacity": bitmap(solid[..., None], wrap, "nearest"), "bsdf": bsdf}
    return bsdf


def mitsuba_quad(q):
    positions, texcoords, order, normal = outline(q)
    texcoords = placed(texcoords, q)
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(mitsuba_bsdf(q))
    if "emission" in q:
        emission = np.array(q["emission"], float)
        radiance = raw(emission)
        if "cutoff" in q:
            # Mitsuba's emitters shine from their holes too.
            solid = resolved(TEXTURES[q["base"]][..., 3] / 255.0) >= q["cutoff"]
            radiance = bitmap(solid[..., None] * emission, q["wrap"], "nearest")
        props["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
    mesh = mi.Mesh("quad", 4, 2, has_vertex_texcoords=True, props=props)
    params = mi.traverse(mesh)
    params["vertex_positions"] = positions.astype(np.float32).ravel()
    params["vertex_texcoords"] = texcoords.astype(np.float32).ravel()
    params["faces"] = np.array(order, np.uint32)
    params.update()
    return mesh


def mitsuba_sky(sky):
    """Tyndall's map has its rows' centres at (y + ½)/16; Mitsuba's rows run from pole to pole. A finer
    map that has all of both lattices' lines is the same function, bilinear in the same cells."""
    pixels = sky_map().astype(np.float64) * sky["radiance"]
    height, width, _ = pixels.shape
    rows = np.clip(np.arange(2 * height + 1) / 2 - 0.5, 0, height - 1)
    low = np.minimum(rows.astype(int), height - 2)
    f = (rows - low)[:, None, None]
    fine = pixels[low] * (1 - f) + pixels[low + 1] * f
    columns = (np.arange(3 * width) + 0.5) / 3 - 0.5
    low = np.floor(columns).astype(int)
    f = (columns - low)[None, :, None]
    fine = fine[:, low % width] * (1 - f) + fine[:, (low + 1) % width] * f
    # The centre column of Mitsuba's maps looks along +Z.
    turn = mi.ScalarTransform4f().rotate([0, 1, 0], sky["rotation_degrees"] + 180)
    return {"type": "envmap", "bitmap": mi.Bitmap(fine.astype(np.float32)), "to_world": turn}


def check_sky():
    """Mitsuba's directions against Tyndall's definition: (sin θ sin φ, cos θ, −sin θ cos φ) is at
    u = ½ + φ/2π, v = θ/π; `rotation_degrees` turns the map about +Y, counter-clockwise from above."""
    sky = {"radiance": [1, 1, 1], "rotation_degrees": 37.0}
    emitter = mi.load_dict(mitsuba_sky(sky))
    pixels, turn = sky_map(), np.radians(37.0)
    for x, y in [(20, 4), (21, 4), (5, 9), (0, 8), (31, 12), (12, 2)]:
        phi, theta = 2 * np.pi * ((x + 0.5) / 32 - 0.5), np.pi * (y + 0.5) / 16
        d = np.array([np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)])
        d = [np.cos(turn) * d[0] + np.sin(turn) * d[2], d[1], np.cos(turn) * d[2] - np.sin(turn) * d[0]]
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.wi = mi.Vector3f(*[-float(c) for c in d])
        found = np.array(emitter.eval(si)).ravel()
        assert np.allclose(found, pixels[y, x], rtol=1e-3), (x, y, found, pixels[y, x])


def check_placement():
    q = {"transform": {"offset": [0, 1], "rotation": np.pi / 2, "scale": [0.5, 0.5]}}
    found = placed(np.array([[0, 0], [1, 1]], float), q)
    assert np.allclose(found, [[0, 1], [0.5, 0.5]]), found


def check_texture():
    """Mitsuba's (0, 0) is the upper left texel's corner, as glTF's."""
    texels = TEXTURES["base_color"] / 255.0
    texture = mi.load_dict(bitmap(texels))
    for x, y in [(0, 0), (63, 0), (5, 40)]:
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.uv = mi.Point2f((x + 0.5) / SIDE, (y + 0.5) / SIDE)
        assert np.allclose(np.array(texture.eval_3(si)).ravel(), texels[y, x], atol=1e-4)


def mitsuba_scene(scene, fog):
    camera = scene["camera"]
    t = mi.ScalarTransform4f
    d = {
        "type": "scene",
        "sensor": {
            "type": "perspective", "fov": camera["fov"], "fov_axis": "y", "near_clip": 1e-3, "far_clip": 1e4,
            "to_world": t().look_at(origin=camera["position"], target=camera["target"], up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "pixel_format": "rgb",
                     "component_format": "float32", "rfilter": {"type": "box"}},
            "sampler": {"type": "independent"},
        },
    }
    for i, q in enumerate(scene["quads"]):
        d[f"quad{i}"] = mitsuba_quad(q)
    if "sky" in scene:
        d["sky"] = mitsuba_sky(scene["sky"])
    if fog:
        low, high = np.array(FOG["min"], float), np.array(FOG["max"], float)
        d["fog"] = {
            "type": "cube", "bsdf": {"type": "null"},
            "to_world": t().translate(list((low + high) / 2)).scale(list((high - low) / 2)),
            "interior": {
                "type": "homogeneous", "sigma_t": {"type": "constvolume", "value": FOG["sigma_t"]},
                "albedo": {"type": "constvolume", "value": FOG["albedo"]},
                "phase": {"type": "hg", "g": FOG["g"]}, "has_spectral_extinction": False,
            },
        }
    return mi.load_dict(d)


def rounded(values, bits):
    """To `bits` of mantissa: far below the noise, and the rest compresses."""
    mantissa, exponent = np.frexp(values.astype(np.float64))
    return np.ldexp(np.round(mantissa * 2.0**bits) / 2.0**bits, exponent).astype(np.float32)


def render(name, scene, fog):
    built = mitsuba_scene(scene, fog)
    k = scene.get("max_scatterings")
    integrator = mi.load_dict({"type": "volpath", "max_depth": -1 if k is None else k + 1, "rr_depth": 8})
    pictures = []
    for seed in range(SEEDS):
        picture = mi.render(built, integrator=integrator, spp=SAMPLES, seed=1000 + seed)
        pictures.append(np.array(picture, dtype=np.float64))
    pictures = np.array(pictures)
    assert np.isfinite(pictures).all()
    mean = pictures.mean(0)
    stderr = pictures.std(0, ddof=1) / np.sqrt(SEEDS)
    np.savez_compressed(
        f"{HERE}/{name}{'_fog' if fog else ''}.npz", mean=rounded(mean, 16), stderr=rounded(stderr, 8),
        samples=np.int64(SEEDS * SAMPLES), source=f"Mitsuba {mi.__version__} {mi.variant()} volpath",
    )
    error = stderr.mean() / mean.mean()
    print(f"{name}{' fog' if fog else ''}: mean {mean.mean((0, 1))}, mean standard error {error:.4f}", flush=True)


def main():
    names = sys.argv[1:] or list(SCENES)
    check_texture()
    check_placement()
    check_sky()
    for image, texels in TEXTURES.items():
        mi.Bitmap(texels).write(f"{HERE}/{image}.png")
    mi.Bitmap(sky_map()).write(f"{HERE}/sky.exr")
    for name in names:
        write_gltf(name, SCENES[name])
        for fog in (False, True) if SCENES[name].get("in_fog", True) else (False,):
            write_json(name, SCENES[name], fog)
            render(name, SCENES[name], fog)


if __name__ == "__main__":
    main()
