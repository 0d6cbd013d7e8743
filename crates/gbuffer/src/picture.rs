//! Pictures of 8 bits a channel: from a shading or a field of numbers, to PNG files.
//!
//! False colours are those of viridis (van der Walt & Smith 2015), whose steps look alike to the eye, from the
//! `colorous` crate.

use crate::GBufferError;
use crate::shade::background;
use colorous::VIRIDIS;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};
use std::io::{self, Write};
use std::path::Path;

/// Width of a legend, pixels; a quarter of it is taken by the ticks.
const LEGEND_WIDTH: usize = 24;

/// Pixels between pictures that stand side by side.
const GAP: usize = 8;

/// Of 100: bands of isophotes show no blocks.
const JPEG_QUALITY: u8 = 95;

/// Ticks of a legend: both ends and each quarter.
const TICKS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

const TICK_COLOUR: [u8; 3] = [235, 235, 235];

/// Shown for a number that is NaN, which no scale has a colour for.
const NAN_COLOUR: [u8; 3] = [255, 0, 255];

/// A grid of colours, at least 1 × 1, row 0 on top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    /// Row-major.
    rgb: Vec<[u8; 3]>,
}

impl Picture {
    /// A picture of `width * height` colours, row-major from the top.
    ///
    /// # Errors
    /// [`GBufferError::PictureSize`] where there are none or another number of them.
    pub fn new(width: usize, height: usize, rgb: Vec<[u8; 3]>) -> Result<Self, GBufferError> {
        let count = rgb.len();
        if count == 0 || width.checked_mul(height) != Some(count) {
            return Err(GBufferError::PictureSize { width, height, count });
        }
        Ok(Self { width, height, rgb })
    }

    /// A picture of `width` × `height` pixels, each at least 1, from a function of column and row.
    fn from_fn(width: usize, height: usize, colour: impl Fn(usize, usize) -> [u8; 3]) -> Self {
        let rgb = (0..width * height).map(|i| colour(i % width, i / width)).collect();
        Self { width, height, rgb }
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The colours, row-major from the top.
    pub fn rgb(&self) -> &[[u8; 3]] {
        &self.rgb
    }

    /// The colour of pixel (x, y).
    ///
    /// # Panics
    /// Outside the picture.
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        assert!(x < self.width, "x inside the picture");
        self.rgb[y * self.width + x]
    }

    /// A picture of one colour, each side at least 1.
    pub(crate) fn plain(width: usize, height: usize, colour: [u8; 3]) -> Self {
        Self::from_fn(width, height, |_, _| colour)
    }

    /// Fills a rectangle, as much of it as is inside.
    pub(crate) fn fill(&mut self, [x, y]: [usize; 2], [width, height]: [usize; 2], colour: [u8; 3]) {
        for row in y.min(self.height)..(y + height).min(self.height) {
            let (start, end) = (x.min(self.width), (x + width).min(self.width));
            self.rgb[row * self.width + start..row * self.width + end].fill(colour);
        }
    }

    /// The picture with another colour where `is_there` says so, of pixel (x, y).
    pub fn recoloured(mut self, colour: [u8; 3], is_there: impl Fn(usize, usize) -> bool) -> Self {
        let width = self.width;
        let chosen = self.rgb.iter_mut().enumerate().filter(|(i, _)| is_there(i % width, i / width));
        chosen.for_each(|(_, rgb)| *rgb = colour);
        self
    }

    /// The picture as the bytes of a PNG file. With `alpha`, a value a pixel, row by row, it is as opaque as that says, and
    /// colours are what is left of them without the share of `behind`, in linear light: they are meant to be put over another
    /// picture.
    ///
    /// # Errors
    /// [`GBufferError::PictureSize`] where there are not as many values as pixels, [`GBufferError::Png`] where there are too
    /// many of them for the format.
    pub fn png(&self, alpha: Option<(&[u8], [u8; 3])>) -> Result<Vec<u8>, GBufferError> {
        let mut bytes = vec![];
        let Some((alpha, behind)) = alpha else {
            self.encode_png(&mut bytes).map_err(unwritable)?;
            return Ok(bytes);
        };
        if alpha.len() != self.rgb.len() {
            let (width, height, count) = (self.width, self.height, alpha.len());
            return Err(GBufferError::PictureSize { width, height, count });
        }
        let over = |rgb: &[u8; 3], alpha: u8| {
            let share = f64::from(alpha) / 255.0;
            let alone = |c: usize| match alpha {
                0 | 255 => rgb[c],
                _ => {
                    let [mixed, back] = [rgb[c], behind[c]].map(light_from_srgb);
                    srgb_from_light(((mixed - (1.0 - share) * back) / share).clamp(0.0, 1.0))
                }
            };
            [alone(0), alone(1), alone(2), alpha]
        };
        let rgba: Vec<[u8; 4]> = self.rgb.iter().zip(alpha).map(|(rgb, alpha)| over(rgb, *alpha)).collect();
        self.encode(&mut bytes, rgba.as_flattened(), ExtendedColorType::Rgba8).map_err(unwritable)?;
        Ok(bytes)
    }

    /// The picture as the bytes of a JPEG file, of quality `JPEG_QUALITY`: sharp edges are not kept as they are.
    ///
    /// # Errors
    /// [`GBufferError::Jpeg`] where there are too many pixels for the format.
    pub fn jpeg(&self) -> Result<Vec<u8>, GBufferError> {
        let too_large = || GBufferError::Jpeg { width: self.width, height: self.height };
        let side = |pixels: usize| u16::try_from(pixels).map_err(|_| too_large());
        let (width, height) = (side(self.width)?, side(self.height)?);
        let mut bytes = vec![];
        JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)
            .write_image(self.rgb.as_flattened(), width.into(), height.into(), ExtendedColorType::Rgb8)
            .map_err(|_| too_large())?;
        Ok(bytes)
    }

    /// Writes the picture to a file in PNG format, whatever its name ends in, replacing what is there.
    ///
    /// # Errors
    /// [`GBufferError::Png`].
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<(), GBufferError> {
        let path = path.as_ref();
        files::write(path, |writer| self.encode_png(writer))
            .map_err(|error| GBufferError::Png { path: path.to_owned(), reason: error.to_string() })
    }

    /// The picture in PNG format.
    fn encode_png(&self, writer: impl Write) -> io::Result<()> {
        self.encode(writer, self.rgb.as_flattened(), ExtendedColorType::Rgb8)
    }

    fn encode(&self, writer: impl Write, bytes: &[u8], colours: ExtendedColorType) -> io::Result<()> {
        let (width, height) = (u32::try_from(self.width), u32::try_from(self.height));
        let (Ok(width), Ok(height)) = (width, height) else {
            return Err(io::Error::other(format!("{}x{} pixels are too many for PNG", self.width, self.height)));
        };
        PngEncoder::new(writer).write_image(bytes, width, height, colours).map_err(|error| match error {
            ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })
    }

    /// A field of numbers in false colour, with a [`Self::legend`] to its right.
    ///
    /// The least of `range` is dark violet and stands at the legend's bottom, the greatest is yellow and on top;
    /// numbers outside take the colour of the nearer end (all that of the lower end, in a range without length).
    /// `None` is shown as background, NaN as magenta. `width` and `height` of 0 are taken as 1.
    pub fn false_colour(
        width: usize,
        height: usize,
        values: impl Fn(usize, usize) -> Option<f64>,
        range: [f64; 2],
    ) -> Self {
        let [least, greatest] = range;
        let colour = |x, y| match values(x, y) {
            None => background(),
            Some(value) if value.is_nan() => NAN_COLOUR,
            // An infinite end makes NaN of its own value.
            Some(value) if value <= least => viridis(0.0),
            Some(value) if value >= greatest => viridis(1.0),
            Some(value) => viridis((value - least) / (greatest - least)),
        };
        let map = Self::from_fn(width.max(1), height.max(1), colour);
        let legend = Self::legend(map.height, viridis);
        Self::beside(&[&map, &legend])
    }

    /// Where and how far two pictures of one size differ: the greatest difference of a channel in false colour, from
    /// 1 to the greatest in the picture, and background where they are equal. The greatest difference comes with it.
    ///
    /// # Errors
    /// [`GBufferError::PictureSizesDiffer`].
    pub fn difference(a: &Self, b: &Self) -> Result<(Self, u8), GBufferError> {
        if (a.width, a.height) != (b.width, b.height) {
            let (a, b) = ([a.width, a.height], [b.width, b.height]);
            return Err(GBufferError::PictureSizesDiffer { a, b });
        }
        let at = |i: usize| (0..3).map(|c| a.rgb[i][c].abs_diff(b.rgb[i][c])).max().expect("three channels");
        let greatest = (0..a.rgb.len()).map(at).max().expect("a picture has pixels");
        let value = |x, y| Some(at(y * a.width + x)).filter(|&d| d > 0).map(f64::from);
        Ok((Self::false_colour(a.width, a.height, value, [1.0, f64::from(greatest)]), greatest))
    }

    /// The mean of pictures of one size, in linear light: colours are decoded from sRGB (IEC 61966-2-1), as screens show
    /// them, added up, and encoded, rounded to the nearest. What is the same in all of them stays as it is.
    ///
    /// Of pictures of a pixel's samples this is the anti-aliased picture. Where a channel of each is off by half a step,
    /// the rounding of [`unorm8`](crate::unorm8), the mean is off by at most a step.
    ///
    /// # Errors
    /// [`GBufferError::NoPictures`], [`GBufferError::PictureSizesDiffer`].
    pub fn average(pictures: &[Self]) -> Result<Self, GBufferError> {
        let [first, rest @ ..] = pictures else { return Err(GBufferError::NoPictures) };
        let (width, height) = (first.width, first.height);
        if let Some(other) = rest.iter().find(|other| (other.width, other.height) != (width, height)) {
            let (a, b) = ([width, height], [other.width, other.height]);
            return Err(GBufferError::PictureSizesDiffer { a, b });
        }
        let light: Vec<f64> = (0..=255).map(light_from_srgb).collect();
        let mean = |i: usize, channel: usize| {
            let sum: f64 = pictures.iter().map(|picture| light[usize::from(picture.rgb[i][channel])]).sum();
            srgb_from_light(sum / pictures.len() as f64)
        };
        let rgb = (0..first.rgb.len()).map(|i| [0, 1, 2].map(|channel| mean(i, channel))).collect();
        Ok(Self { width, height, rgb })
    }

    /// A vertical strip of the colours of a scale, from `colour(1.0)` on top to `colour(0.0)` at the bottom, with a tick
    /// at both ends and at each quarter. 24 pixels wide; a height of 0 is taken as 1.
    pub fn legend(height: usize, colour: impl Fn(f64) -> [u8; 3]) -> Self {
        let height = height.max(1);
        let last = (height - 1) as f64;
        Self::from_fn(LEGEND_WIDTH, height, |x, y| {
            let is_tick = || TICKS.iter().any(|t| ((1.0 - t) * last).round() as usize == y);
            match x {
                _ if x < LEGEND_WIDTH * 3 / 4 => colour(if last > 0.0 { 1.0 - y as f64 / last } else { 1.0 }),
                _ if x > LEGEND_WIDTH * 3 / 4 && is_tick() => TICK_COLOUR,
                _ => background(),
            }
        })
    }

    /// Pictures side by side from the left, 8 pixels apart, their upper edges in line. No picture gives one of a
    /// single pixel of background.
    pub fn beside(pictures: &[&Self]) -> Self {
        let height = pictures.iter().map(|p| p.height).max().unwrap_or(1);
        let width = pictures.iter().map(|p| p.width + GAP).sum::<usize>().saturating_sub(GAP).max(1);
        let mut all = Self::from_fn(width, height, |_, _| background());
        let mut left = 0;
        for picture in pictures {
            for (row, source) in picture.rgb.chunks_exact(picture.width).enumerate() {
                let start = row * width + left;
                all.rgb[start..start + picture.width].copy_from_slice(source);
            }
            left += picture.width + GAP;
        }
        all
    }
}

/// Where a PNG file would be written to memory: nothing is wrong but the picture's size.
fn unwritable(error: io::Error) -> GBufferError {
    GBufferError::Png { path: "-".into(), reason: error.to_string() }
}

/// Linear light, 0 to 1, of an sRGB value of 8 bits. libm's power, so that pictures do not depend on the platform's.
fn light_from_srgb(value: u8) -> f64 {
    let x = f64::from(value) / 255.0;
    if x <= 0.04045 { x / 12.92 } else { libm::pow((x + 0.055) / 1.055, 2.4) }
}

/// The sRGB value, of 8 bits, nearest to linear light from 0 to 1.
fn srgb_from_light(light: f64) -> u8 {
    let x = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 };
    (255.0 * x).round() as u8
}

/// The colour of 0 to 1.
fn viridis(t: f64) -> [u8; 3] {
    VIRIDIS.eval_continuous(t).into_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_file_holds_the_pictures_bytes() {
        let picture = Picture::from_fn(5, 3, |x, y| [x as u8 * 50, y as u8 * 100, 7]);
        // The process number keeps two test runs apart.
        let path = std::env::temp_dir().join(format!("isophote_picture_{}.any", std::process::id()));
        picture.write_png(&path).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        let back = image::load_from_memory_with_format(&bytes, image::ImageFormat::Png).unwrap().into_rgb8();
        assert_eq!((back.dimensions(), &back.into_raw()[..]), ((5, 3), picture.rgb().as_flattened()));
        assert!(matches!(picture.write_png("/no/such/directory/x.png"), Err(GBufferError::Png { .. })));
        // So small a picture stays in a buffer until that is flushed.
        #[cfg(unix)]
        assert!(matches!(picture.write_png("/dev/full"), Err(GBufferError::Png { .. })));
    }

    #[test]
    fn a_transparent_picture_keeps_the_colours_of_what_it_shows() {
        // White over black, of which half a pixel is covered, is 188 of sRGB; by itself it is white again.
        let picture = Picture::new(3, 1, vec![[255; 3], [188; 3], [0; 3]]).unwrap();
        let bytes = picture.png(Some((&[255, 128, 0], [0; 3]))).unwrap();
        let back = image::load_from_memory_with_format(&bytes, image::ImageFormat::Png).unwrap().into_rgba8();
        let pixels: Vec<[u8; 4]> = back.pixels().map(|pixel| pixel.0).collect();
        assert_eq!((pixels[0], pixels[2]), ([255; 4], [0; 4]));
        assert!(pixels[1][0] >= 254 && pixels[1][3] == 128, "{pixels:?}");
        assert!(matches!(picture.png(Some((&[0], [0; 3]))), Err(GBufferError::PictureSize { .. })));
    }

    #[test]
    fn a_wrong_number_of_colours_is_refused() {
        assert!(Picture::new(2, 3, vec![[0; 3]; 6]).is_ok());
        for (width, height, count) in [(2, 3, 5), (0, 3, 0), (usize::MAX, 2, 1)] {
            let result = Picture::new(width, height, vec![[0; 3]; count]);
            assert!(matches!(result, Err(GBufferError::PictureSize { .. })));
        }
    }

    #[test]
    fn false_colours_run_from_violet_to_yellow_and_clamp() {
        let values = [Some(-5.0), Some(0.0), Some(10.0), Some(f64::INFINITY), None, Some(f64::NAN)];
        let picture = Picture::false_colour(6, 1, |x, _| values[x], [0.0, 10.0]);
        let row: Vec<_> = (0..6).map(|x| picture.pixel(x, 0)).collect();
        assert_eq!(row[..2], [viridis(0.0); 2]);
        assert_eq!(row[2..4], [viridis(1.0); 2]);
        assert_eq!(row[4..], [background(), NAN_COLOUR]);
        // Matplotlib's ends of the map, within the rounding of its spline.
        for (found, expected) in [(viridis(0.0), [68, 1, 84]), (viridis(1.0), [253, 231, 37])] {
            assert!(found.iter().zip(expected).all(|(a, b): (&u8, u8)| a.abs_diff(b) <= 1), "{found:?}");
        }
    }

    #[test]
    fn a_range_without_length_shows_the_lower_end() {
        let picture = Picture::false_colour(1, 1, |_, _| Some(3.0), [3.0, 3.0]);
        assert_eq!(picture.pixel(0, 0), viridis(0.0));
    }

    #[test]
    fn a_legend_has_its_greatest_value_on_top_and_five_ticks() {
        let legend = Picture::legend(101, viridis);
        assert_eq!((legend.pixel(0, 0), legend.pixel(0, 100)), (viridis(1.0), viridis(0.0)));
        let ticks: Vec<_> = (0..101).filter(|&y| legend.pixel(LEGEND_WIDTH - 1, y) == TICK_COLOUR).collect();
        assert_eq!(ticks, [0, 25, 50, 75, 100]);
        assert_eq!(Picture::legend(0, viridis).height(), 1);
    }

    #[test]
    fn pictures_stand_side_by_side_with_a_gap() {
        let (a, b) = (Picture::plain(2, 3, [1; 3]), Picture::plain(1, 1, [2; 3]));
        let all = Picture::beside(&[&a, &b]);
        assert_eq!((all.width(), all.height()), (2 + GAP + 1, 3));
        assert_eq!((all.pixel(1, 2), all.pixel(2, 0), all.pixel(2 + GAP, 0)), ([1; 3], background(), [2; 3]));
        assert_eq!(all.pixel(2 + GAP, 1), background());
        assert_eq!(Picture::beside(&[]), Picture::plain(1, 1, background()));
    }

    #[test]
    fn an_average_is_one_of_light() {
        let (black, white) = (Picture::plain(2, 1, [0; 3]), Picture::plain(2, 1, [255; 3]));
        // Half the light of white is shown by 188, three quarters by 225 (sRGB; by a gamma of 2.2: 186 and 224).
        let mean = |pictures: &[Picture]| Picture::average(pictures).unwrap().pixel(1, 0)[0];
        assert_eq!(mean(&[black.clone(), white.clone()]), 188);
        assert_eq!(mean(&[white.clone(), black.clone(), white.clone(), white.clone()]), 225);
        for value in 0..=255 {
            let same = Picture::plain(1, 1, [value, 0, 255]);
            assert_eq!(Picture::average(&[same.clone(), same.clone(), same.clone()]).unwrap(), same);
        }
        assert!(matches!(Picture::average(&[]), Err(GBufferError::NoPictures)));
        let other = Picture::average(&[black, Picture::plain(1, 2, [0; 3])]);
        assert!(matches!(other, Err(GBufferError::PictureSizesDiffer { .. })));
    }

    #[test]
    fn a_difference_shows_the_pixels_that_differ() {
        let a = Picture::plain(3, 1, [10, 20, 30]);
        let mut b = a.clone();
        b.rgb[1] = [11, 20, 30];
        b.rgb[2] = [10, 20, 130];
        let (picture, greatest) = Picture::difference(&a, &b).unwrap();
        assert_eq!(greatest, 100);
        assert_eq!([0, 1, 2].map(|x| picture.pixel(x, 0)), [background(), viridis(0.0), viridis(1.0)]);
        assert_eq!(Picture::difference(&a, &a).unwrap().1, 0);
        let other = Picture::plain(1, 3, [0; 3]);
        assert!(matches!(Picture::difference(&a, &other), Err(GBufferError::PictureSizesDiffer { .. })));
    }
}
