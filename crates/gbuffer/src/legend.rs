//! The legend of a picture: a strip of its colours, with a title that names the unit, and numbers.

use crate::lettering::{ADVANCE, ROWS, write};
use crate::{Picture, background};

/// Letters grow by a step with every so many rows of the picture.
const ROWS_A_STEP: usize = 384;

/// The least height, pixels: a title and two numbers.
const LEAST_HEIGHT: usize = 48;

/// Width of the strip and length of a tick, in points of a letter.
const STRIP: usize = 18;
const TICK: usize = 3;

/// Between a tick and its number: a sign must not seem to be part of the tick.
const GAP: usize = 4;

const INK: [u8; 3] = [235, 235, 235];

impl Picture {
    /// A strip of the colours of a scale, from `colour(1.0)` on top to `colour(0.0)` at the bottom, below a title. Each tick has
    /// its place from 0 to 1 and its number. As high as asked, and at least 48 pixels.
    pub(crate) fn numbered_legend(
        height: usize,
        title: &str,
        ticks: &[(f64, String)],
        colour: impl Fn(f64) -> [u8; 3],
    ) -> Self {
        let height = height.max(LEAST_HEIGHT);
        let size = height.div_ceil(ROWS_A_STEP);
        let columns = |text: &str| text.chars().count() * ADVANCE * size;
        let numbers = ticks.iter().map(|(_, text)| columns(text)).max().unwrap_or(0);
        let width = ((STRIP + TICK + GAP) * size + numbers).max(columns(title)) + 2 * size;
        let mut picture = Self::plain(width, height, background());
        write(&mut picture, title, [size, size], size, INK);
        // Half a number stands above the strip and below it.
        let (top, bottom) = ((ROWS + 3 + ROWS / 2 + 1) * size, height - 1 - (ROWS / 2 + 1) * size);
        let row = |t: f64| bottom - (t * (bottom - top) as f64).round() as usize;
        for y in top..=bottom {
            let t = (bottom - y) as f64 / (bottom - top) as f64;
            picture.fill([0, y], [STRIP * size, 1], colour(t));
        }
        for (place, text) in ticks {
            let y = row(place.clamp(0.0, 1.0));
            picture.fill([STRIP * size, y], [TICK * size, size], INK);
            write(&mut picture, text, [(STRIP + TICK + GAP) * size, y - ROWS / 2 * size], size, INK);
        }
        picture
    }
}

/// A number of three digits, as short as it is plain.
pub(crate) fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e5).contains(&size) => {
            let digits = (2 - size.log10().floor() as i32).max(0) as usize;
            let text = format!("{x:.digits$}");
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => text,
            }
        }
        _ => format!("{x:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_keep_three_digits() {
        let cases = [
            (0.0, "0"),
            (1.0, "1"),
            (-0.125, "-0.125"),
            (22.5, "22.5"),
            (1234.5, "1234"),
            (0.00123456, "0.00123"),
            (1.5e-7, "1.50e-7"),
            (-2e6, "-2.00e6"),
        ];
        for (x, text) in cases {
            assert_eq!(number(x), text);
        }
    }

    #[test]
    fn a_legend_shows_its_ends_its_ticks_and_its_letters() {
        let ticks = [(0.0, "0".to_owned()), (1.0, "90°".to_owned())];
        let legend = Picture::numbered_legend(200, "1/mm", &ticks, |t| [(255.0 * t) as u8, 0, 0]);
        let strip: Vec<u8> = (0..200).map(|y| legend.pixel(1, y)).filter(|c| c[1..] == [0, 0]).map(|c| c[0]).collect();
        assert_eq!((strip.first(), strip.last()), (Some(&255), Some(&0)));
        // "1/mm" above, "90°" and "0" beside: as many points as their glyphs have.
        let ink = |from: usize, to: usize| {
            let all = (from..to).flat_map(|y| (0..legend.width()).map(move |x| (x, y)));
            all.filter(|&(x, y)| legend.pixel(x, y) == INK).count()
        };
        assert_eq!(ink(0, 9), 10 + 5 + 2 * 13);
        assert_eq!(ink(150, 200), 19 + TICK);
        assert_eq!(Picture::numbered_legend(1, "", &[], |_| [0; 3]).height(), LEAST_HEIGHT);
    }
}
