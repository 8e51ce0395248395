//! How far a step leads before a surface: it ends a margin away from it, and slides along.

use glam::DVec3;

use super::solids::Solids;

/// Surfaces that one step may slide along, one after the other.
const MOST_SLIDES: usize = 4;
/// How far ahead surfaces are looked for, in margins: at a flat angle one comes near late.
const LOOK_AHEAD: f64 = 12.0;
/// Steps that lead farther away than any scene reaches are left to the camera's own rules. Unit: m.
const FARTHEST: f64 = 1e7;

/// Where an eye ends that turns about a pivot: what it slides along leads it back to its distance. Unit: m.
pub(super) fn turn(solids: &Solids, from: DVec3, to: DVec3, pivot: DVec3) -> DVec3 {
    let at = walk(solids, from, to);
    let reach = to.distance(pivot);
    let outward = (at - pivot).normalize_or_zero();
    if at == to || outward == DVec3::ZERO {
        return at;
    }
    walk(solids, at, pivot + outward * reach)
}

/// Where an eye ends that wants to go from one place straight to another. Unit: m.
pub(super) fn walk(solids: &Solids, from: DVec3, to: DVec3) -> DVec3 {
    let margin = solids.margin();
    let (mut at, mut rest) = (from, to - from);
    if !rest.is_finite() || rest.abs().max_element() > FARTHEST {
        return to;
    }
    let mut met: Vec<DVec3> = Vec::with_capacity(MOST_SLIDES);
    for _ in 0..MOST_SLIDES {
        let length = rest.length();
        if length < 1e-9 {
            return at;
        }
        let direction = rest / length;
        let hit = solids.closest(at, direction, length + LOOK_AHEAD * margin);
        let Some(hit) = hit else { return at + rest };
        let normal = solids.normal_against(hit.triangle, direction);
        let cosine = -normal.dot(direction);
        let free = (f64::from(hit.distance) - margin / cosine.max(1e-6)).clamp(0.0, length);
        at += direction * free;
        if free >= length {
            return at;
        }
        rest -= direction * free;
        rest -= normal * rest.dot(normal).min(0.0);
        // In a corner the way along one surface leads into another that was met before.
        for other in &met {
            if rest.dot(*other) < -1e-12 {
                let crease = other.cross(normal).normalize_or_zero();
                rest = crease * rest.dot(crease);
            }
        }
        met.push(normal);
    }
    at
}
