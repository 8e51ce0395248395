"""Makes the images of fixtures/ and what PyPI's flip-evaluator and NumPy say about them.

    pip install flip-evaluator==1.7 numpy && python make_fixtures.py

Run with flip-evaluator 1.7 and numpy 2.4.6 on Python 3.11. LDR images are 8-bit sRGB (binary PPM),
HDR images and error maps raw little-endian float32, rows from the top; expected.json has the rest.
"""
import json, os
import numpy as np
import flip_evaluator as flip

W, H = 72, 48
HERE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "fixtures")
rng = np.random.default_rng(7)
y, x = np.mgrid[0:H, 0:W].astype(np.float64)
u, v = (x + 0.5) / W, (y + 0.5) / H


def scene():
    """A fog gradient with edges, a coloured disc and thin bars, linear in [0, 1]."""
    image = np.stack([0.2 + 0.6 * u, 0.3 + 0.4 * v, 0.5 * np.ones_like(u)], -1)
    image[(x // 12 + y // 12) % 2 == 0] *= 0.5
    image[(u - 0.7) ** 2 + (v - 0.4) ** 2 < 0.03] = [0.8, 0.1, 0.1]
    image[:, 20:22] = [0.05, 0.2, 0.7]
    image[30:31, :] = [0.9, 0.9, 0.2]
    return image


def encode(linear):
    linear = np.clip(linear, 0, 1)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.round(srgb * 255).astype(np.uint8)


def ppm(name, image):
    with open(f"{HERE}/{name}.ppm", "wb") as file:
        file.write(b"P6\n%d %d\n255\n" % (W, H) + image.tobytes())


def raw(name, image):
    np.ascontiguousarray(image, "<f4").tofile(f"{HERE}/{name}.f32")


expected = {"flip_evaluator": "1.7", "width": W, "height": H, "cases": {}}


def case(name, reference, test, kind):
    error, mean, parameters = flip.evaluate(reference, test, kind, applyMagma=False)
    raw(name, error.reshape(H, W))
    numbers = {k: float(p) for k, p in parameters.items() if isinstance(p, (int, float)) and np.isfinite(p)}
    expected["cases"][name] = {"mean": float(mean), **numbers}


base = scene()
noisy = base + 0.08 * rng.standard_normal(base.shape)
noisy[:, 40:] = np.roll(noisy[:, 40:], 1, axis=1)
ldr = [encode(base), encode(noisy)]
ppm("ldr_reference", ldr[0])
ppm("ldr_test", ldr[1])
case("ldr_error", *[(image / 255).astype(np.float32) for image in ldr], "LDR")

light = np.exp(-((u - 0.3) ** 2 + (v - 0.3) ** 2) / 0.004)[..., None] * np.array([60.0, 45.0, 20.0])
hdr = (0.4 * base + light).astype(np.float32)
test = (hdr * (1 + 0.15 * rng.standard_normal(hdr.shape)) * np.array([1.05, 1.0, 0.95])).clip(0)
test = test.astype(np.float32)
raw("hdr_reference", hdr)
raw("hdr_test", test)
case("hdr_error", hdr, test, "HDR")



def measures(image, reference, image_se, reference_se):
    """The formulas of the reference images' compare.py, in NumPy."""
    I, R, seI, se = (a.astype(float) for a in (image, reference, image_se, reference_se))
    e2, mean = (I - R) ** 2, R.mean()

    def trim(a):
        return np.sort(a.mean(-1).ravel())[: -int(np.ceil(0.001 * a.shape[0] * a.shape[1]))]

    def blocks(a):
        return a.reshape(H // 8, 8, W // 8, 8, 3).mean((1, 3))

    z = (blocks(I) - blocks(R)) / np.sqrt(blocks(se**2 + seI**2) / 64 + 1e-14)
    return {
        "relative_rmse": np.sqrt(e2.mean()) / mean,
        "relative_rmse_debiased": np.sqrt(max(0, e2.mean() - (se**2).mean())) / mean,
        "relative_rmse_trim": np.sqrt(trim(e2).mean()) / mean,
        "relative_mse": (e2 / (R**2 + 1e-2)).mean(),
        "relative_mse_trim": trim(e2 / (R**2 + 1e-2)).mean(),
        "mean_ratio": I.mean() / mean,
        "reference_error_trim": np.sqrt(trim(se**2).mean()) / mean,
        "block_z_mean": z.mean(),
        "block_z_deviation": z.std(),
        "block_z_max": np.abs(z).max(),
        "block_z_outside_3": int((np.abs(z) > 3).sum()),
    }


# The tests build the same standard errors: a twentieth of the picture, a tenth of the reference.
found = measures(test, hdr, np.float32(0.05) * test, np.float32(0.1) * hdr)
expected["measures"] = {k: float(v) for k, v in found.items()}

with open(f"{HERE}/expected.json", "w") as file:
    json.dump(expected, file, indent=1)
    file.write("\n")
