use pipeline::enclosure::*;
use pipeline::*;
fn main() {
    let model = formats::builtin("teapot").unwrap();
    let scene = PackedScene::new(&model, Scheme::Specialised).unwrap();
    for curv in [false, true] {
        for _ in 0..3 {
            let n = 100000;
            let t = std::time::Instant::now();
            let mut x = 0.0;
            let mut y = 0.0f32;
            for i in 0..n {
                let f = (i % 32) as u32;
                let uv = [(i as f32 * 0.618034) % 1.0, (i as f32 * 0.754877) % 1.0];
                for e in enclose(&scene, f, uv.map(Parameter::exact), curv).iter() {
                    x += e.position.unwrap()[0].half_width;
                }
            }
            let a = t.elapsed().as_secs_f64() / n as f64 * 1e6;
            let t = std::time::Instant::now();
            for i in 0..n {
                let f = (i % 32) as u32;
                let uv = [(i as f32 * 0.618034) % 1.0, (i as f32 * 0.754877) % 1.0];
                y += fragment::fragment(&scene, f, uv, curv).position[0];
            }
            println!("{curv} enclose {a:.2} us fragment {:.3} us {x} {y}", t.elapsed().as_secs_f64() / n as f64 * 1e6);
        }
    }
}
