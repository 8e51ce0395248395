//! Cuts a long dispatch into several, so that none of them takes longer than a device may be silent.

use super::adapter::AdapterKind;

/// Loop iterations of one dispatch, by the upper bounds that plans give: what takes about a tenth of a
/// second. In software 1.2e8 a second on two cores, measured on a march of 512 strata with one mapped lamp; 7e8
/// on that of the fogged hall.
pub(crate) fn most_iterations(kind: AdapterKind) -> u64 {
    match kind {
        AdapterKind::Gpu => 1 << 31,
        AdapterKind::Software | AdapterKind::Other => 1 << 24,
    }
}

/// Workgroups along an axis of one dispatch.
const MOST_ALONG_AN_AXIS: u32 = 65_535;

/// Loop iterations of one frame: more would keep the device from answering for minutes.
pub(crate) fn most_frame_iterations(kind: AdapterKind) -> u64 {
    let dispatches = match kind {
        AdapterKind::Gpu => 1024,
        AdapterKind::Software | AdapterKind::Other => 4096,
    };
    dispatches * most_iterations(kind)
}

/// Workgroups of one dispatch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Part {
    pub first: [u32; 3],
    pub count: [u32; 3],
}

/// Workgroups that one dispatch may have where each has so many invocations that loop so often.
pub(super) fn most_groups(kind: AdapterKind, invocations: u32, iterations: u64) -> u32 {
    let group = u64::from(invocations.max(1)).saturating_mul(iterations.max(1));
    u32::try_from(most_iterations(kind) / group)
        .unwrap_or(u32::MAX)
        .max(1)
}

/// Parts of at most `most` groups that cover `groups` without overlapping.
pub(super) fn parts(groups: [u32; 3], most: u32) -> Vec<Part> {
    let [x, y, z] = groups;
    let all = u64::from(x) * u64::from(y) * u64::from(z);
    if all <= u64::from(most) && x.max(y).max(z) <= MOST_ALONG_AN_AXIS {
        return vec![Part {
            first: [0; 3],
            count: groups,
        }];
    }
    let width = x.min(most).min(MOST_ALONG_AN_AXIS);
    let height = (most / width).clamp(1, y.clamp(1, MOST_ALONG_AN_AXIS));
    let mut parts = Vec::new();
    for layer in 0..z {
        for row in (0..y).step_by(height as usize) {
            for column in (0..x).step_by(width as usize) {
                parts.push(Part {
                    first: [column, row, layer],
                    count: [width.min(x - column), height.min(y - row), 1],
                });
            }
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_every_group_once_and_keep_to_the_bound() {
        for groups in [
            [1, 1, 1],
            [160, 90, 1],
            [7, 5, 3],
            [1000, 1, 1],
            [200_000, 1, 1],
            [3, 200, 2],
        ] {
            for most in [1, 2, 7, 64, 100_000] {
                let parts = parts(groups, most);
                let count = |part: &Part| part.count.map(u64::from).iter().product::<u64>();
                let all: u64 = groups.map(u64::from).iter().product();
                assert_eq!(parts.iter().map(count).sum::<u64>(), all, "{groups:?}");
                assert!(parts.iter().all(|part| count(part) <= u64::from(most)));
                let mut firsts: Vec<_> = parts.iter().map(|part| part.first).collect();
                firsts.sort_unstable();
                firsts.dedup();
                assert_eq!(firsts.len(), parts.len());
                let inside =
                    |part: &Part| (0..3).all(|i| part.first[i] + part.count[i] <= groups[i]);
                assert!(parts.iter().all(inside));
                let short = |part: &Part| part.count.iter().all(|n| *n <= MOST_ALONG_AN_AXIS);
                assert!(parts.iter().all(short));
            }
        }
    }

    #[test]
    fn the_longest_march_of_a_scene_is_cut_into_single_groups() {
        // Lights × steps × media, 64 invocations a group.
        let iterations = 4096 * 4096 * 256;
        assert_eq!(most_groups(AdapterKind::Gpu, 64, iterations), 1);
        assert!(most_groups(AdapterKind::Gpu, 64, 1000) > 10_000);
    }
}
