//! How long passes take, in tests that compare two ways in one run.

use tyndall_render::{Renderer, View};

/// The least time of each of `passes` over `frames` frames of a view, 0 where it did not run: what else
/// runs on the machine only adds. Unit: ms.
pub fn least_millis<const N: usize>(
    renderer: &mut Renderer,
    view: &mut View,
    frames: u32,
    passes: [&str; N],
) -> [f64; N] {
    let mut least = [f64::INFINITY; N];
    for _ in 0..frames {
        renderer.render(view, 0).expect("a frame");
        renderer.wait().expect("a device that answers");
        let frame = view.take_finished().expect("the frame arrived");
        let frame = frame.expect("the frame can be read");
        for (least, pass) in least.iter_mut().zip(passes) {
            let of = frame.pass_times.iter().filter(|t| t.name == pass);
            *least = least.min(of.fold(0.0, |sum, t| sum + f64::from(t.micros) / 1e3));
        }
    }
    least
}
