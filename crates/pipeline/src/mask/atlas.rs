//! Rectangles on shelves: where each tile stands in the atlas.

/// The greatest side of an atlas, texels: what most adapters have, and far below where f32 holds no whole numbers.
pub(super) const GREATEST_SIDE: u32 = 16_384;

/// Where tiles stand, and the atlas around them.
pub(super) struct Atlas {
    pub size: [u32; 2],
    pub corners: Vec<[u32; 2]>,
}

/// Tiles of the given sizes on shelves, the tallest first; `None` where they do not fit into `memory` bytes.
///
/// Tiles touch: what is drawn of a mask stays in the box of its own loops.
pub(super) fn shelve(sizes: &[[u32; 2]], memory: u64) -> Option<Atlas> {
    let area: u64 = sizes.iter().map(|[w, h]| u64::from(*w) * u64::from(*h)).sum();
    let widest = sizes.iter().map(|size| size[0]).max().unwrap_or(0).max(1);
    // Wide enough for a square, and no wider than memory allows a square to be, or the widest tile asks for.
    let square = ((area as f64).sqrt() * 1.05) as u32 + 1;
    let greatest = ((memory as f64).sqrt() as u32).min(GREATEST_SIDE);
    let width = square.min(greatest).max(widest);
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(sizes[i][1]));
    let mut corners = vec![[0; 2]; sizes.len()];
    let (mut x, mut y, mut height, mut used) = (0u32, 0u32, 0u32, 1u32);
    for i in order {
        let [w, h] = sizes[i];
        if x + w > width {
            (x, y, height) = (0, y.checked_add(height)?, 0);
        }
        corners[i] = [x, y];
        x += w;
        used = used.max(x);
        height = height.max(h);
    }
    let size = [used, y.checked_add(height)?.max(1)];
    let bytes = u64::from(size[0]) * u64::from(size[1]);
    (bytes <= memory && size.iter().all(|&side| side <= GREATEST_SIDE)).then_some(Atlas { size, corners })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_tiles_share_a_texel_and_little_is_lost() {
        let sizes: Vec<[u32; 2]> = (0..300).map(|i| [1 + i * 7 % 40, 1 + i * 13 % 30]).collect();
        let atlas = shelve(&sizes, 1 << 20).expect("they fit");
        let [width, height] = atlas.size.map(|side| side as usize);
        let mut taken = vec![false; width * height];
        for ([x, y], [w, h]) in atlas.corners.iter().zip(&sizes) {
            for row in *y..y + h {
                for column in *x..x + w {
                    let texel = &mut taken[row as usize * width + column as usize];
                    assert!(!std::mem::replace(texel, true), "({column}, {row}) is taken twice");
                }
            }
        }
        let share = taken.iter().filter(|t| **t).count() as f64 / taken.len() as f64;
        assert!(share > 0.8, "{share} of the atlas is used");
        assert!(shelve(&sizes, 1 << 10).is_none());
        assert!(shelve(&[[1, 4], [GREATEST_SIDE, 1]], 1 << 20).is_some());
    }
}
