//! `--cropwindow` and `--tile`: which pixels of the picture are rendered.

use super::Failure;
use super::args_output::OutputArguments;
use crate::image::Window;

/// The window; none where all of the picture is rendered.
///
/// # Errors
///
/// It holds no pixel.
pub(super) fn window(arguments: &OutputArguments, resolution: [u32; 2]) -> Result<Option<Window>, Failure> {
    let [width, height] = resolution.map(|n| n as usize);
    // As pbrt rounds: windows that share a border share no pixel.
    let pixel = |share: f64, pixels: usize| (share * pixels as f64).ceil() as usize;
    let window = match (arguments.cropwindow, arguments.tile) {
        (Some([x0, x1, y0, y1]), _) => {
            let (left, right) = (pixel(x0, width), pixel(x1, width));
            let (top, bottom) = (pixel(y0, height), pixel(y1, height));
            Window { left, top, width: right - left, height: bottom - top }
        }
        (None, Some([index, count])) => {
            let [top, bottom] = [index - 1, index].map(|edge| height * edge as usize / count as usize);
            Window { left: 0, top, width, height: bottom - top }
        }
        (None, None) => return Ok(None),
    };
    if !window.is_within([width, height]) {
        let reason = format!("there is no pixel in that part of a picture of {width} by {height} pixels");
        return Err(Failure::Usage(reason));
    }
    Ok(Some(window))
}
