//! Stands in for `tyndall_volume::read` until the file readers are there: reads uncompressed
//! `.npz` files of little-endian float32 arrays in C order, `[z][y][x]`.

use std::path::Path;

use glam::{DAffine3, DVec3, UVec3};
use tyndall_volume::{Grid, GridBuilder, VolumeError, VolumeLimits};

pub(super) struct ReadOptions {
    pub(super) grid: Option<String>,
}

pub(super) fn read(
    path: &Path,
    options: &ReadOptions,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    let length = std::fs::metadata(path)?.len();
    if length > limits.file_bytes {
        return Err(VolumeError::Limit {
            what: "bytes of the file",
            found: length,
            limit: limits.file_bytes,
        });
    }
    let bytes = std::fs::read(path)?;
    let (mut rest, mut names) = (bytes.as_slice(), Vec::new());
    while let Some((name, member, after)) = member(rest) {
        let name = name.strip_suffix(".npy").unwrap_or(name);
        if options.grid.as_deref().is_none_or(|wanted| wanted == name) {
            return array(name, member, limits);
        }
        names.push(name.to_owned());
        rest = after;
    }
    if names.is_empty() {
        let what = "this file".to_owned();
        let field = "format".to_owned();
        return Err(VolumeError::Unsupported { field, what });
    }
    let wanted = options.grid.clone().unwrap_or_default();
    Err(VolumeError::invalid("grid", wanted, names.join(", ")))
}

fn number(bytes: &[u8], at: usize, length: usize) -> Option<usize> {
    let bytes = bytes.get(at..at + length)?;
    Some(
        bytes
            .iter()
            .rev()
            .fold(0, |n, byte| n << 8 | usize::from(*byte)),
    )
}

/// Name and bytes of the first member of a zip file, and the rest.
fn member(bytes: &[u8]) -> Option<(&str, &[u8], &[u8])> {
    if number(bytes, 0, 4)? != 0x0403_4b50 || number(bytes, 8, 2)? != 0 {
        return None;
    }
    let start = 30 + number(bytes, 26, 2)?;
    let name = std::str::from_utf8(bytes.get(30..start)?).ok()?;
    let data = bytes.get(start + number(bytes, 28, 2)?..)?;
    let (data, rest) = data.split_at_checked(number(bytes, 22, 4)?)?;
    Some((name, data, rest))
}

fn array(name: &str, bytes: &[u8], limits: &VolumeLimits) -> Result<Grid, VolumeError> {
    let wrong = || VolumeError::invalid("header", "another", "float32 [z][y][x]");
    let header = 10 + number(bytes, 8, 2).ok_or_else(wrong)?;
    let text = bytes.get(10..header).ok_or_else(wrong)?;
    let text = std::str::from_utf8(text).map_err(|_utf8| wrong())?;
    let sides = text.split(['(', ')']).nth(1).ok_or_else(wrong)?;
    let sides: Vec<u32> = sides
        .split(',')
        .filter_map(|n| n.trim().parse().ok())
        .collect();
    let [z, y, x] = sides[..] else {
        return Err(wrong());
    };
    let mut builder = GridBuilder::new([x, y, z], limits)?;
    let size = UVec3::new(x, y, z);
    let bricks = size.map(|side| side.div_ceil(8));
    for index in 0..bricks.element_product() {
        let brick = UVec3::new(
            index % bricks.x,
            index / bricks.x % bricks.y,
            index / bricks.x / bricks.y,
        );
        let values = std::array::from_fn(|i| {
            let v = brick * 8 + UVec3::new(i as u32 % 8, i as u32 / 8 % 8, i as u32 / 64);
            if v.cmpge(size).any() {
                return 0.0;
            }
            let entry = (v.x + x * (v.y + y * v.z)) as usize;
            number(bytes, header + 4 * entry, 4).map_or(0.0, |bits| f32::from_bits(bits as u32))
        });
        builder.set_brick(brick, &values)?;
    }
    let size = size.as_dvec3();
    let placed = DAffine3::from_scale(size.recip()) * DAffine3::from_translation(DVec3::splat(0.5));
    Ok(builder.finish(name, placed, [DVec3::splat(-0.5), size - 0.5]))
}
