"""Meshes, materials and textures of a scene that tyndall exported, as Mitsuba's objects.

Imported by mitsuba_job.py once the variant is set. Texels go in as decoded numbers, so that Mitsuba's
own decoding and 16-bit storage play no part.
"""
import os

import drjit as dr
import mitsuba as mi
import numpy as np

# Places a texel at which a mask is decided beforehand: Mitsuba interpolates what it masks by.
MASK_FINENESS = 16


def bitmap(values, wrap, filter_type="bilinear"):
    """A texture of linear numbers, row 0 at v = 0 as glTF's."""
    if wrap[0] != wrap[1]:
        raise ValueError("a texture that wraps differently along u and v")
    tensor = mi.TensorXf(np.ascontiguousarray(values, dtype=np.float32))
    return {
        "type": "bitmap", "data": tensor, "raw": True, "wrap_mode": wrap[0],
        "filter_type": filter_type, "format": "variant",
    }


def constant(values):
    """A constant that need be no reflectance."""
    return bitmap(np.full((2, 2, len(values)), values, np.float32), ("repeat", "repeat"))


class MetallicRoughness(mi.BSDF):
    """glTF 2.0, appendix B: (1 − F)·diffuse/π + F·D·V with Schlick's F at the half vector, GGX and the
    height-correlated Smith term. None of Mitsuba's own has this sum and this Smith term."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.base, self.surface = props["base"], props["surface"]
        lobes = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.GlossyReflection
        self.m_components = [lobes | mi.BSDFFlags.FrontSide]
        self.m_flags = self.m_components[0]

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
            return 0.5 * (dr.sqrt(1 + alpha * alpha * (1 / (cosine * cosine) - 1)) - 1)

        distribution = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)
        specular = distribution.eval(h) / (1 + smith_lambda(i) + smith_lambda(o)) / (4 * i * o)
        value = ((1 - fresnel) * diffuse * dr.inv_pi + fresnel * specular) * o
        density = 0.5 * o * dr.inv_pi + 0.5 * distribution.pdf(si.wi, h) / (4 * dr.dot(wo, h))
        return dr.select(valid, value, 0), dr.select(valid, density, 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        _, alpha, _ = self.parameters(si, active)
        distribution = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)
        m, _ = distribution.sample(si.wi, sample2)
        cosine = mi.warp.square_to_cosine_hemisphere(sample2)
        wo = dr.select(sample1 < 0.5, cosine, mi.reflect(si.wi, m))
        value, density = self.value_and_density(si, wo, active)
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo, bs.pdf, bs.eta = wo, density, 1.0
        bs.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
        bs.sampled_component = mi.UInt32(0)
        return bs, dr.select(density > 0, value / density, 0)

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


class Textures:
    """Textures by their index in the job."""

    def __init__(self, job, folder):
        self.entries, self.folder = job["textures"], folder

    def texels(self, index):
        """RGBA, RGB linear; and how it wraps."""
        entry = self.entries[index]
        data = np.fromfile(os.path.join(self.folder, entry["file"]), "u1")
        x = data.reshape(entry["height"], entry["width"], 4).astype(np.float64) / 255
        if entry["srgb"]:
            linear = np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)
            x = np.concatenate([linear[..., :3], x[..., 3:]], -1)
        return x, entry["wrap"]

    def solid(self, mesh):
        """Where a mask leaves a surface, as 0 and 1 at many places a texel; and how it wraps."""
        alpha, wrap = np.full((2, 2), mesh["alpha"]), ["repeat", "repeat"]
        if mesh["base_color_texture"] is not None:
            texels, wrap = self.texels(mesh["base_color_texture"])
            alpha = alpha[0, 0] * texels[..., 3]
        for axis in (0, 1):
            alpha = finer(alpha, axis, wrap[axis])
        return (alpha >= mesh["alpha_cutoff"])[..., None].astype(np.float64), wrap


def finer(values, axis, wrap):
    """Linear interpolation along an axis."""
    n = values.shape[axis]
    place = (np.arange(n * MASK_FINENESS) + 0.5) / MASK_FINENESS - 0.5
    low = np.floor(place).astype(int)
    f = place - low
    if wrap == "repeat":
        low, high = low % n, (low + 1) % n
    else:
        low, high = np.clip(low, 0, n - 1), np.clip(low + 1, 0, n - 1)
    f = f[:, None] if axis == 0 else f
    return values.take(low, axis) * (1 - f) + values.take(high, axis) * f


def bsdf(mesh, textures, mirrored):
    color = np.array(mesh["reflectance"], float)
    textured, surface = mesh["base_color_texture"], mesh["surface_texture"]
    if textured is not None:
        texels, wrap = textures.texels(textured)
        base = bitmap(texels[..., :3] * color, wrap)
    elif mesh["colors"]:
        # The factor is in the attribute.
        base = {"type": "mesh_attribute", "name": "vertex_color"}
    else:
        base = constant(color)
    roughness, metallic = mesh["roughness"], mesh["metallic"]
    if surface is not None:
        texels, wrap = textures.texels(surface)
        found = bitmap(texels[..., :3] * [1, roughness, metallic], wrap)
        inner = {"type": "tyndall_metallic_roughness", "base": base, "surface": found}
    elif metallic > 0 or roughness < 1:
        found = constant([0, roughness, metallic])
        inner = {"type": "tyndall_metallic_roughness", "base": base, "surface": found}
    else:
        inner = {"type": "diffuse", "reflectance": base}
    if mesh["normal_texture"] is not None:
        texels, wrap = textures.texels(mesh["normal_texture"])
        scale = mesh["normal_scale"]
        # glTF's bitangent points up in the image, Mitsuba's is normal × tangent: where the image is seen
        # mirrored the two are opposite.
        normal = (texels[..., :3] * 2 - 1) * [scale, -scale if mirrored else scale, 1]
        inner = {
            "type": "normalmap", "normalmap": bitmap(0.5 + 0.5 * normal, wrap), "bsdf": inner,
            "flip_invalid_normals": False, "use_shadowing_function": False,
        }
    if mesh["two_sided"]:
        inner = {"type": "twosided", "bsdf": inner}
    if mesh["alpha_cutoff"] is not None:
        solid, wrap = textures.solid(mesh)
        inner = {"type": "mask", "opacity": bitmap(solid, wrap, "nearest"), "bsdf": inner}
    return inner


def radiance(mesh, textures):
    emission = np.array(mesh["emission"], float)
    if mesh["emission_texture"] is not None:
        texels, wrap = textures.texels(mesh["emission_texture"])
        return bitmap(texels[..., :3] * emission, wrap)
    if mesh["alpha_cutoff"] is not None:
        # Mitsuba's emitters shine from their holes, too.
        solid, wrap = textures.solid(mesh)
        return bitmap(solid * emission, wrap, "nearest")
    # A bitmap counts as varying, and would ask for texture coordinates.
    return {"type": "rgb", "value": [float(value) for value in emission]}


def parts(mesh, folder):
    """Triangles whose image is seen the right way round, and mirrored ones, with their arrays."""

    def read(name, columns, kind="<f4"):
        if not mesh[name]:
            return None
        return np.fromfile(os.path.join(folder, mesh[name]), kind).reshape(-1, columns)

    positions, triangles = read("positions", 3), read("indices", 3, "<u4")
    normals, texcoords, colors = read("normals", 3), read("texcoords", 2), read("colors", 3)
    arrays = positions, normals, texcoords, colors
    if mesh["normal_texture"] is None:
        return [(False, triangles, arrays)]
    corner = texcoords[triangles]
    d1, d2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    mirrored = d1[:, 0] * d2[:, 1] - d2[:, 0] * d1[:, 1] > 0
    both = [(False, triangles[~mirrored], arrays), (True, triangles[mirrored], arrays)]
    return [part for part in both if len(part[1])]


def shape(name, mesh, textures, mirrored, triangles, arrays):
    positions, normals, texcoords, colors = arrays
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(bsdf(mesh, textures, mirrored))
    props["face_normals"] = normals is None
    if max(mesh["emission"]) > 0:
        props["emitter"] = mi.load_dict({"type": "area", "radiance": radiance(mesh, textures)})
    made = mi.Mesh(
        name, len(positions), len(triangles), props=props,
        has_vertex_normals=normals is not None, has_vertex_texcoords=texcoords is not None,
    )
    params = mi.traverse(made)
    params["vertex_positions"] = positions.ravel()
    params["faces"] = triangles.ravel()
    if normals is not None:
        params["vertex_normals"] = normals.ravel()
    if texcoords is not None:
        params["vertex_texcoords"] = texcoords.ravel()
    params.update()
    if colors is not None:
        factors = np.array(mesh["reflectance"], np.float32)
        made.add_attribute("vertex_color", 3, (colors * factors).astype(np.float32).ravel())
    return made


def build(job, folder):
    """All meshes by name."""
    mi.register_bsdf("tyndall_metallic_roughness", MetallicRoughness)
    textures = Textures(job, folder)
    built = {}
    for i, mesh in enumerate(job["meshes"]):
        for mirrored, triangles, arrays in parts(mesh, folder):
            name = "mesh%d%s" % (i, "_mirrored" if mirrored else "")
            built[name] = shape(name, mesh, textures, mirrored, triangles, arrays)
    return built
