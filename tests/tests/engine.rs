//! What the engine can do beyond what today's passes need.

use tyndall_render::probe::engine::{SIDE, added_levels, pool_bytes, shared_bytes};
use tyndall_tests::{gpu, probes};

#[test]
fn draws_without_geometry_add_up_in_one_level_and_leave_the_others_alone() {
    let device = gpu::device();
    let [whole, half] = added_levels(&device, probes::named("probe_cover"), 3).expect("drawn");
    assert_eq!(whole.len(), (SIDE * SIDE) as usize);
    assert!(whole.iter().all(|value| *value == 0.0), "{whole:?}");
    // Three triangles by a plain draw and three by an indirect one, 0.25 each.
    assert_eq!(half, vec![1.5; (SIDE * SIDE / 4) as usize]);
}

#[test]
fn the_pool_knows_the_bytes_of_levels_and_volumes() {
    let device = gpu::device();
    let levels = 16 * 16 + 8 * 8 + 4 * 4;
    let expected = levels * 8 + 4 * 4 * 8 * 16;
    assert_eq!(pool_bytes(&device).expect("made"), expected);
}

#[test]
fn textures_that_are_not_needed_at_the_same_time_share_memory() {
    let device = gpu::device();
    let one = u64::from(SIDE * SIDE) * 8;
    assert_eq!(shared_bytes(&device).expect("made"), [one, 2 * one]);
}
