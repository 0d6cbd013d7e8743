//! The letters of "Isophote" as a font has them: contours of quadratic Béziers, counted in 2048ths of an em.
//!
//! They are glyphs of DejaVu Sans 2.37 (`DejaVuSans.ttf`), number for number; `testdata/README.md` has the licence. Outer
//! contours run clockwise and counters counter-clockwise, which is how loops that cut the letters out must run.

/// A point of a contour: x and y in 2048ths of an em, and whether the contour passes through it.
pub(super) type ContourPoint = (i16, i16, bool);

/// The contour passes through the point.
const ON: bool = true;

/// The point only pulls.
const OFF: bool = false;

/// A letter: how far it moves the pen, in 2048ths of an em, and its contours.
pub(super) type Letter = (i16, &'static [&'static [ContourPoint]]);

/// The letters of the word in order; `o` stands in it twice.
pub(super) const WORD: [Letter; 8] = [I, S, O, P, H, O, T, E];

#[rustfmt::skip]
const I: Letter = (604, &[
    &[(201, 1493, ON), (403, 1493, ON), (403, 0, ON), (201, 0, ON)],
]);

#[rustfmt::skip]
const S: Letter = (1067, &[
    &[(907, 1087, ON), (907, 913, ON), (829, 953, OFF), (661, 993, OFF), (571, 993, ON), (434, 993, OFF),
      (297, 909, OFF), (297, 825, ON), (297, 761, OFF), (395, 688, OFF), (543, 655, ON), (606, 641, ON),
      (802, 599, OFF), (967, 446, OFF), (967, 309, ON), (967, 153, OFF), (720, -29, OFF), (504, -29, ON),
      (414, -29, OFF), (219, 6, OFF), (111, 41, ON), (111, 231, ON), (213, 178, OFF), (411, 125, OFF), (508, 125, ON),
      (638, 125, OFF), (778, 214, OFF), (778, 295, ON), (778, 370, OFF), (677, 450, OFF), (506, 487, ON),
      (442, 502, ON), (271, 538, OFF), (119, 687, OFF), (119, 817, ON), (119, 975, OFF), (343, 1147, OFF),
      (549, 1147, ON), (651, 1147, OFF), (831, 1117, OFF)],
]);

#[rustfmt::skip]
const O: Letter = (1253, &[
    &[(627, 991, ON), (479, 991, OFF), (307, 760, OFF), (307, 559, ON), (307, 358, OFF), (478, 127, OFF),
      (627, 127, ON), (774, 127, OFF), (946, 359, OFF), (946, 559, ON), (946, 758, OFF), (774, 991, OFF)],
    &[(627, 1147, ON), (867, 1147, OFF), (1141, 835, OFF), (1141, 559, ON), (1141, 284, OFF), (867, -29, OFF),
      (627, -29, ON), (386, -29, OFF), (113, 284, OFF), (113, 559, ON), (113, 835, OFF), (386, 1147, OFF)],
]);

#[rustfmt::skip]
const P: Letter = (1300, &[
    &[(371, 168, ON), (371, -426, ON), (186, -426, ON), (186, 1120, ON), (371, 1120, ON), (371, 950, ON),
      (429, 1050, OFF), (606, 1147, OFF), (729, 1147, ON), (933, 1147, OFF), (1188, 823, OFF), (1188, 559, ON),
      (1188, 295, OFF), (933, -29, OFF), (729, -29, ON), (606, -29, OFF), (429, 68, OFF)],
    &[(997, 559, ON), (997, 762, OFF), (830, 993, OFF), (684, 993, ON), (538, 993, OFF), (371, 762, OFF),
      (371, 559, ON), (371, 356, OFF), (538, 125, OFF), (684, 125, ON), (830, 125, OFF), (997, 356, OFF)],
]);

#[rustfmt::skip]
const H: Letter = (1298, &[
    &[(1124, 676, ON), (1124, 0, ON), (940, 0, ON), (940, 670, ON), (940, 829, OFF), (816, 987, OFF), (692, 987, ON),
      (543, 987, OFF), (371, 797, OFF), (371, 633, ON), (371, 0, ON), (186, 0, ON), (186, 1556, ON), (371, 1556, ON),
      (371, 946, ON), (437, 1047, OFF), (616, 1147, OFF), (733, 1147, ON), (926, 1147, OFF), (1124, 908, OFF)],
]);

#[rustfmt::skip]
const T: Letter = (803, &[
    &[(375, 1438, ON), (375, 1120, ON), (754, 1120, ON), (754, 977, ON), (375, 977, ON), (375, 369, ON),
      (375, 232, OFF), (450, 154, OFF), (565, 154, ON), (754, 154, ON), (754, 0, ON), (565, 0, ON), (352, 0, OFF),
      (190, 159, OFF), (190, 369, ON), (190, 977, ON), (55, 977, ON), (55, 1120, ON), (190, 1120, ON), (190, 1438, ON)],
]);

#[rustfmt::skip]
const E: Letter = (1260, &[
    &[(1151, 606, ON), (1151, 516, ON), (305, 516, ON), (317, 326, OFF), (522, 127, OFF), (705, 127, ON),
      (811, 127, OFF), (1010, 179, OFF), (1108, 231, ON), (1108, 57, ON), (1009, 15, OFF), (801, -29, OFF),
      (694, -29, ON), (426, -29, OFF), (113, 283, OFF), (113, 549, ON), (113, 824, OFF), (410, 1147, OFF),
      (662, 1147, ON), (888, 1147, OFF), (1151, 856, OFF)],
    &[(967, 660, ON), (965, 811, OFF), (800, 991, OFF), (664, 991, ON), (510, 991, OFF), (325, 817, OFF),
      (311, 659, ON)],
]);
