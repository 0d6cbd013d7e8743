//! The CPU rasterizer's G-buffers: the same on any number of threads, and those that were blessed.

use gbuffer::GBuffer;
use processors::golden::GOLDENS;
use processors::hashes;
use rayon::ThreadPoolBuilder;
use techniques::fragment::Fragment;
use xtask::bless;

/// The largest golden file, bytes.
const LARGEST: u64 = 256 * 1024;

#[test]
fn raster_is_the_same_to_the_byte_on_any_number_of_threads_and_equals_its_golden() {
    for golden in GOLDENS {
        let model = golden.model();
        let buffers: Vec<GBuffer> = [1, 2, 7]
            .into_iter()
            .map(|threads| {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
                pool.install(|| golden.raster(&model, &Fragment))
            })
            .collect();
        let bytes: Vec<Vec<u8>> = buffers.iter().map(|buffer| buffer.npz_bytes().expect("bytes")).collect();
        assert!(bytes[0] == bytes[1] && bytes[1] == bytes[2], "{} depends on the number of threads", golden.name);
        let path = bless::path(golden);
        let size = std::fs::metadata(&path).expect("`cargo xtask bless` writes goldens").len();
        assert!(size <= LARGEST, "{} has {size} bytes", golden.name);
        let blessed = GBuffer::read_npz(&path).expect("a readable golden");
        let differing = blessed.pixels().zip(buffers[0].pixels()).filter(|(a, b)| a != b).count();
        assert_eq!(
            differing,
            0,
            "{} of {} pixels differ from the golden {}",
            differing,
            buffers[0].covered(),
            golden.name
        );
    }
}

#[test]
fn a_golden_notices_a_change_in_the_last_bit() {
    let golden = &GOLDENS[0];
    let blessed = GBuffer::read_npz(bless::path(golden)).expect("a readable golden");
    let viewport = blessed.viewport();
    let mut changed = false;
    let rows = (0..viewport.height()).map(|y| {
        (0..viewport.width())
            .map(|x| {
                blessed.get(x, y).map(|hit| {
                    let mut hit = *hit;
                    if !std::mem::replace(&mut changed, true) {
                        hit.uv.x = hit.uv.x.next_up();
                    }
                    hit
                })
            })
            .collect()
    });
    let rows: Vec<Vec<_>> = rows.collect();
    let other = GBuffer::from_rows(viewport, blessed.meta().clone(), rows);
    assert_eq!(blessed.pixels().zip(other.pixels()).filter(|(a, b)| a != b).count(), 1);
}

#[test]
fn every_golden_picture_has_its_blessed_hash() {
    let blessed = std::fs::read_to_string(bless::hashes_path()).expect("`cargo xtask bless` writes hashes");
    let lines: Vec<String> = hashes::lines().collect();
    assert!(lines.len() > 100, "{} pictures", lines.len());
    assert_eq!(hashes::differences(&blessed, &lines), [""; 0]);
}
