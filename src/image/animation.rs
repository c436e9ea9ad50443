//! Animated PNG: frames of one size, played again and again.

use super::files::ImageError;
use super::png::{BitDepth, Samples, invalid};
use super::{Film, Window};
use std::cell::RefCell;
use std::io::Write;
use std::rc::Rc;

/// A file in the making, a frame at a time; only its encoded frames are kept.
pub struct Animation {
    bytes: SharedBytes,
    frames: u32,
    rate: u16,
    depth: BitDepth,
    has_alpha: bool,
    /// The size of the frames and whether they are opaque, once there is one.
    shape: Option<(Window, bool)>,
    writer: Option<png::Writer<SharedBytes>>,
}

impl Animation {
    /// Of so many frames, `rate` a second; with `has_alpha`, frames may be transparent.
    pub fn new(frames: u32, rate: u16, depth: BitDepth, has_alpha: bool) -> Self {
        Self { bytes: SharedBytes::default(), frames, rate, depth, has_alpha, shape: None, writer: None }
    }

    /// Appends a frame.
    ///
    /// # Errors
    ///
    /// It differs from the first one in size or is not opaque where all have to be, or it is one too many.
    pub fn push(&mut self, film: &Film) -> Result<(), ImageError> {
        let samples = Samples::of_film(film, self.depth, self.has_alpha);
        let shape = (Window::whole(samples.width, samples.height), samples.is_opaque);
        if *self.shape.get_or_insert(shape) != shape {
            return Err(invalid("the frames differ in size or in opacity".to_owned()));
        }
        let failed = |error: png::EncodingError| invalid(error.to_string());
        let writer = match &mut self.writer {
            Some(writer) => writer,
            none => {
                let mut encoder = samples.encoder(self.bytes.clone())?;
                encoder.validate_sequence(true);
                encoder.set_animated(self.frames, 0).map_err(failed)?;
                encoder.set_frame_delay(1, self.rate).map_err(failed)?;
                none.insert(encoder.write_header().map_err(failed)?)
            }
        };
        writer.write_image_data(&samples.bytes).map_err(failed)
    }

    /// The bytes of the file.
    ///
    /// # Errors
    ///
    /// Frames are missing.
    pub fn finish(self) -> Result<Vec<u8>, ImageError> {
        let writer = self.writer.ok_or_else(|| invalid("there is no frame".to_owned()))?;
        writer.finish().map_err(|error| invalid(error.to_string()))?;
        Ok(self.bytes.0.take())
    }
}

/// Bytes that the encoder writes and this module takes back.
#[derive(Clone, Default)]
struct SharedBytes(Rc<RefCell<Vec<u8>>>);

impl Write for SharedBytes {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(light: f32, alpha: f32) -> Film {
        let mut film = Film::new(4, 3);
        film.color.fill([light, light, light, alpha]);
        film
    }

    #[test]
    fn frames_come_back_in_order() {
        let mut animation = Animation::new(3, 25, BitDepth::Eight, false);
        for light in [0.0, 0.25, 1.0] {
            animation.push(&film(light, 1.0)).expect("a frame");
        }
        let bytes = animation.finish().expect("a file");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
        let control = reader.info().animation_control.expect("animated");
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        let mut codes = vec![0; reader.output_buffer_size().expect("small")];
        for code in [0, 137, 255] {
            reader.next_frame(&mut codes).expect("a frame");
            assert_eq!(codes, [code; 36]);
            assert_eq!(reader.info().frame_control.expect("control").delay_den, 25);
        }
    }

    #[test]
    fn frames_with_alpha_may_be_opaque() {
        let mut animation = Animation::new(2, 25, BitDepth::Sixteen, true);
        animation.push(&film(0.5, 1.0)).expect("an opaque frame");
        animation.push(&film(0.5, 0.5)).expect("another");
        animation.finish().expect("a file");
    }

    #[test]
    fn odd_and_missing_frames_are_errors() {
        let mut animation = Animation::new(2, 25, BitDepth::Sixteen, false);
        animation.push(&film(0.5, 1.0)).expect("a frame");
        assert!(animation.push(&film(0.5, 0.5)).is_err());
        assert!(animation.finish().is_err(), "one frame of two");
        assert!(Animation::new(1, 25, BitDepth::Eight, true).finish().is_err());
    }
}
