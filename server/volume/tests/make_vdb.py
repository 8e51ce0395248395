"""Writes the fixtures beside this script: OpenVDB and NanoVDB files, and what OpenVDB finds in them.

    apt-get install python3-openvdb libnanovdb-tools && pip install blosc
    /usr/bin/python3 server/volume/tests/make_vdb.py

Debian's OpenVDB 10.0.1 is the oracle. It writes blosc only, so `transcode` writes such
a file again with other codings, block by block; OpenVDB reads the result, too.
"""

import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

import numpy as np
import pyopenvdb as vdb

FOLDER = pathlib.Path(__file__).parent / "fixtures"
RANDOM = np.random.default_rng(7)


def fog(name="density", background=0.0):
    grid = vdb.FloatGrid(background)
    grid.name = name
    grid.gridClass = vdb.GridClass.FOG_VOLUME
    return grid


def blob(grid, low=(-11, -3, 5), size=(14, 12, 10), amplitude=2.0):
    """A soft ball of noise, inactive where it is 0."""
    axes = [np.linspace(-1, 1, side) for side in size]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    ball = np.clip(1 - np.sqrt(x * x + y * y + z * z), 0, None)
    values = amplitude * ball * RANDOM.random(size)
    grid.copyFromArray(values.astype(np.float32), ijk=low)
    return grid


def expected(grid):
    """Boxes, placement and every stored value that is not 0 inside the active box."""
    result = {"name": grid.name, "active": grid.activeVoxelCount()}
    to_world = grid.transform.indexToWorld
    result["world"] = [list(to_world(p)) for p in [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]]
    if grid.activeVoxelCount() == 0:
        return result
    low, high = grid.evalActiveVoxelBoundingBox()
    result["low"], result["high"] = list(low), list(high)
    accessor = grid.getConstAccessor()
    size = [high[i] - low[i] + 1 for i in range(3)]
    if np.prod(size) < 40000:
        values = np.zeros(size, np.float32)
        for index in np.ndindex(*size):
            values[index] = accessor.getValue(tuple(int(low[i] + index[i]) for i in range(3)))
        points = [tuple(p) for p in np.argwhere(values != 0)]
    else:
        points = [tuple(int(RANDOM.integers(s)) for s in size) for _ in range(100)]
        result["sampled"] = True
    listed = []
    for point in points:
        index = tuple(int(low[i] + point[i]) for i in range(3))
        value = accessor.getValue(index)
        bits = struct.unpack("<I", struct.pack("<f", value))[0]
        listed.append([*index, bits])
    result["voxels"] = listed
    return result


def write(name, grids):
    path = FOLDER / f"{name}.vdb"
    vdb.write(str(path), grids=grids)
    data = bytearray(path.read_bytes())
    # The file's identifier, which is random otherwise.
    data[21:57] = b"00000000-0000-4000-8000-000000000000"
    path.write_bytes(data)
    read, _ = vdb.readAll(str(path))
    text = json.dumps([expected(grid) for grid in read], separators=(",", ":"))
    (FOLDER / f"{name}.json").write_text(text + "\n")


def transforms():
    grids = []
    for name, build in [
        ("uniform", lambda t: None),
        ("scale", lambda t: t.scale((1.0, 2.0, 0.5))),
        ("translate", lambda t: t.translate((3.0, -2.0, 1.5))),
        ("scale_translate", lambda t: (t.scale((1.0, 2.0, 0.5)), t.translate((3.0, 4.0, 5.0)))),
        ("rotate", lambda t: t.rotate(0.7, vdb.Axis.Z)),
        ("shear", lambda t: (t.shear(0.3, vdb.Axis.X, vdb.Axis.Y), t.translate((1.0, 2.0, 3.0)))),
    ]:
        grid = fog(name)
        grid.transform = vdb.createLinearTransform(0.25)
        build(grid.transform)
        grids.append(grid)
    for name, matrix in [
        ("identity", [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
        ("translation", [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [5, 6, 7, 1]]),
        ("unitary", [[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
        ("affine", [[0, 2, 0, 0], [-3, 0, 1, 0], [0, 0.5, 4, 0], [1, 2, 3, 1]]),
    ]:
        grid = fog(name)
        grid.transform = vdb.createLinearTransform(matrix)
        grids.append(grid)
    return grids


def tiles():
    """Tiles of every level: 8³ and 128³ voxels in nodes, 4096³ in the root, some inactive."""
    grid = fog()
    grid.fill((-8, 0, 0), (40, 24, 16), 0.5)
    grid.fill((128, 128, 128), (255, 255, 263), 0.25)
    grid.fill((1, 1, 1), (5, 6, 7), 2.0)
    grid.fill((24, 8, 0), (31, 15, 7), 0.75, active=False)
    return grid


def far_apart():
    grid = fog()
    grid.fill((-4100, -5, 3), (-4097, 4, 9), 1.0)
    grid.fill((4096, -2, 5), (4099, 3, 8), 2.0)
    return grid


def root_tile():
    grid = fog()
    grid.fill((0, 0, 0), (4095, 4095, 4095), 0.125)
    return grid


def inactive():
    """Inactive voxels with one, two and many values of their own."""
    grid = fog()
    for at, count in enumerate([1, 2, 3, 9]):
        origin = 8 * at
        grid.fill((origin, 0, 0), (origin + 7, 7, 7), 1.0, active=True)
        accessor = grid.getAccessor()
        for step in range(60):
            place = (origin + step % 8, step * 3 % 8, step * 5 % 8)
            accessor.setValueOff(place, 0.25 * (step % count))
        for step in range(20):
            accessor.setValueOn((origin + step % 8, step * 7 % 8, step % 5), 0.5 + step)
    return grid


def odd_values():
    grid = fog()
    grid.fill((0, 0, 0), (7, 7, 7), 1.0)
    accessor = grid.getAccessor()
    for at, value in enumerate([float("nan"), float("inf"), -float("inf"), -1.0, -0.0, 3e38]):
        accessor.setValueOn((at, 0, 0), value)
    return grid


def half(grid):
    grid.saveFloatAsHalf = True
    return grid


class Transcoder:
    """Copies a file of one float grid and stores its values in another way."""

    def __init__(self, data, half, flags):
        self.data, self.at, self.out = data, 0, bytearray()
        self.half, self.flags = half, flags

    def take(self, count):
        self.at += count
        return self.data[self.at - count : self.at]

    def copy(self, count):
        taken = self.take(count)
        self.out += taken
        return taken

    def number(self, form):
        return struct.unpack("<" + form, self.copy(struct.calcsize("<" + form)))[0]

    def text(self):
        return self.copy(self.number("I"))

    def metadata(self):
        """Drops the sizes of the blocks, which delayed loading would trust."""
        count = struct.unpack("<I", self.take(4))[0]
        kept = []
        for _ in range(count):
            start = self.at
            name = self.take(struct.unpack("<I", self.take(4))[0])
            for _ in range(2):
                self.take(struct.unpack("<I", self.take(4))[0])
            if name != b"file_delayed_load":
                kept.append(self.data[start : self.at])
        self.out += struct.pack("<I", len(kept)) + b"".join(kept)

    def block(self, count):
        if self.half and count == 0:
            return b""
        size = struct.unpack("<q", self.take(8))[0]
        if size <= 0:
            return self.take(-size)
        import blosc

        return blosc.decompress(self.take(size)) if count else self.take(size) * 0

    def values(self, mask):
        count, start = 8 * len(mask), self.at
        bits = np.unpackbits(np.frombuffer(mask, np.uint8), bitorder="little").astype(bool)
        kind = self.take(1)[0]
        inactive = [0.0, 0.0]
        for at in range({2: 1, 4: 1, 5: 2}.get(kind, 0)):
            inactive[at] = struct.unpack("<f", self.take(4))[0]
        chosen = bits * 0
        if kind in (3, 4, 5):
            chosen = np.unpackbits(np.frombuffer(self.take(len(mask)), np.uint8), bitorder="little")
        stored = count if kind == 6 else int(bits.sum())
        head = self.data[start : self.at]
        plain = self.block(stored)
        if self.flags & 2:
            self.out += head
            if stored or not self.half:
                self.pack(plain)
            return
        packed = np.frombuffer(plain, np.float16 if self.half else np.float32)
        if kind == 6:
            full = packed
        else:
            full = np.where(chosen, inactive[1], inactive[0]).astype(packed.dtype)
            full[bits] = packed
        self.out.append(6)
        self.pack(full.tobytes())

    def pack(self, plain):
        if self.flags & 1:
            packed = zlib.compress(plain)
            if len(packed) < len(plain):
                self.out += struct.pack("<q", len(packed)) + packed
                return
            self.out += struct.pack("<q", -len(plain))
        self.out += plain

    def node(self, log2):
        length = (1 << 3 * log2) // 8
        children = self.copy(length)
        active = self.copy(length)
        self.values(active)
        for _ in range(sum(byte.bit_count() for byte in children)):
            if log2 == 5:
                self.node(4)
            else:
                self.copy(64)
                self.leaves += 1

    def run(self, version):
        self.copy(8)
        self.number("I")
        self.out[8:12] = struct.pack("<I", version)
        self.copy(8 + 1 + 36)
        self.metadata()
        assert self.number("i") == 1
        [self.text() for _ in range(3)]
        offsets = len(self.out)
        self.copy(24)
        start = len(self.out)
        self.number("I")
        self.out[start : start + 4] = struct.pack("<I", self.flags)
        self.metadata()
        self.text()
        self.copy(15 * 8)
        self.number("i")
        self.number("f")
        tiles, children = self.number("I"), self.number("I")
        self.copy(17 * tiles)
        self.leaves = 0
        for _ in range(children):
            self.copy(12)
            self.node(5)
        blocks = len(self.out)
        for _ in range(self.leaves):
            self.values(self.copy(64))
        self.out[offsets : offsets + 24] = struct.pack("<qqq", start, blocks, len(self.out))
        return bytes(self.out)


def transcode(name, source, half, flags, version):
    data = (FOLDER / f"{source}.vdb").read_bytes()
    path = FOLDER / f"{name}.vdb"
    path.write_bytes(Transcoder(data, half, flags).run(version))
    read, _ = vdb.readAll(str(path))
    text = json.dumps([expected(grid) for grid in read], separators=(",", ":"))
    assert text + "\n" == (FOLDER / f"{source}.json").read_text(), name


def convert(name, source, *options):
    """NanoVDB files by Debian's converter, and what they read back as."""
    path = FOLDER / f"{name}.nvdb"
    subprocess.run(
        ["nanovdb_convert", "-f", *options, str(FOLDER / f"{source}.vdb"), str(path)],
        check=True, stdout=subprocess.DEVNULL,
    )
    with tempfile.TemporaryDirectory() as folder:
        back = f"{folder}/{name}.vdb"
        command = ["nanovdb_convert", "-f", str(path), back]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        read, _ = vdb.readAll(back)
    text = json.dumps([expected(grid) for grid in read], separators=(",", ":"))
    (FOLDER / f"{name}.nvdb.json").write_text(text + "\n")


def blosc_chunks():
    """Chunks of every codec, and the bytes they hold, for the decoder alone."""
    import blosc

    floats = np.cumsum(RANDOM.integers(0, 3, 1600)).astype(np.float32)
    plain = floats.tobytes()
    (FOLDER / "blosc.bin").write_bytes(plain)
    for codec in ["blosclz", "lz4", "lz4hc", "zlib", "zstd"]:
        for shuffle in [0, 1]:
            chunk = blosc.compress(plain, typesize=4, clevel=9, shuffle=shuffle, cname=codec)
            (FOLDER / f"blosc_{codec}_{shuffle}.bin").write_bytes(chunk)
    chunk = blosc.compress(plain, typesize=4, shuffle=2, cname="lz4")
    (FOLDER / "blosc_bitshuffle.bin").write_bytes(chunk)
    blosc.set_blocksize(1024)
    chunk = blosc.compress(plain, typesize=4, clevel=5, shuffle=1, cname="lz4")
    (FOLDER / "blosc_blocks.bin").write_bytes(chunk)


def main():
    FOLDER.mkdir(exist_ok=True)
    write("plain", [blob(fog())])
    inside = (4, 6, 1), (9, 7, 8)
    small = blob(fog(), *inside)
    write("small", [small])
    write("small_half", [half(small.deepCopy())])
    transcode("zip", "small", False, 1, 224)
    transcode("zip_half", "small_half", True, 1, 223)
    transcode("zip_mask", "small", False, 3, 222)
    transcode("none", "small", False, 2, 223)
    transcode("none_half", "small_half", True, 2, 224)
    write("transforms", transforms())
    write("tiles", [tiles()])
    write("root_tile", [root_tile()])
    write("far_apart", [far_apart()])
    write("inactive", [inactive()])
    transcode("zip_inactive", "inactive", False, 1, 222)
    write("odd_values", [odd_values()])
    write("empty", [fog()])
    shared = blob(fog("first"), *inside)
    second = shared.copy()
    second.name = "second"
    second.transform = vdb.createLinearTransform(2.0)
    write("instance", [shared, second])
    several = [blob(fog(), *inside, a) for a in (1.0, 3.0)]
    vector, ints = vdb.Vec3SGrid(), vdb.BoolGrid()
    vector.name, ints.name = "velocity", "mask"
    write("several", [vector, ints, blob(fog("heat"), *inside), *several])
    level_set = fog("surface", background=0.3)
    level_set.gridClass = vdb.GridClass.LEVEL_SET
    level_set.fill((0, 0, 0), (1, 1, 1), -0.1)
    write("level_set", [level_set])
    for bits in ["4", "8", "16", "N"]:
        convert(f"fp{bits}", "small", f"--fp{bits}", "-z")
    convert("float_blosc", "small", "-b")
    convert("tiles", "tiles", "-z")
    convert("several", "several", "-z", "-g", "density")
    blosc_chunks()
    total = sum(path.stat().st_size for path in FOLDER.iterdir())
    print(f"{total} bytes in {FOLDER}", file=sys.stderr)


main()
