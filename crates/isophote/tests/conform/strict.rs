//! The suite by strict programs: a GPU's G-buffer must be the CPU rasterizer's, to the bit.

use crate::setting::{gpu, plans, run_plans};
use gbuffer::{GBuffer, Hit};
use isophote::conform::check::check;
use isophote::conform::report::{Report, State, Subject};
use isophote::conform::run::{Adapter, DrawError, Plans, by_capsule};
use isophote::conform::{junit, table};
use isophote::stage::{OnGpu, Path, Stage};

/// The first two of the quick scenes: llvmpipe compiles a strict program for a quarter of a minute.
fn strict() -> Plans {
    let plans = plans();
    Plans { scenes: plans.scenes[..2].to_vec(), path: Path::Strict, ..plans }
}

/// An adapter that has the CPU rasterizer's bits, but for the last one of one number.
struct OneBit;

impl Adapter for OneBit {
    fn subject(&self) -> Subject {
        let name = |name: &str| name.to_owned();
        let host = gpu::capsule::Host {
            adapter: name("one bit"),
            driver: name("none"),
            backend: name("none"),
            compiler: name("none"),
        };
        by_capsule(&host, "a test")
    }

    fn draw(&mut self, stage: &Stage) -> Result<OnGpu, DrawError> {
        let right = stage.raster();
        let (width, height) = (right.viewport().width(), right.viewport().height());
        let flipped = |x, y, hit: &Hit| {
            let mut hit = *hit;
            if (x, y) == (width / 2, height / 2) {
                hit.position.x = hit.position.x.next_up();
            }
            hit
        };
        let row = |y| (0..width).map(|x| right.get(x, y).map(|hit| flipped(x, y, hit))).collect::<Vec<_>>();
        let meta = gbuffer::Meta { renderer: "gpu".to_owned(), ..right.meta().clone() };
        let gbuffer = GBuffer::from_rows(right.viewport(), meta, (0..height).map(row));
        Ok(OnGpu { gbuffer, shaded: None, moves_px: None })
    }
}

#[test]
fn by_strict_programs_a_gpu_has_the_rasterizers_bits() {
    let plans = strict();
    let report = run_plans(&plans, Box::new(gpu()));
    assert_eq!(report.state(), State::Agree, "{}", table::text(&report));
    for case in &report.cases {
        let [cpu, gpu] = &case.outcomes[..] else { panic!("two outcomes") };
        assert_eq!((gpu.bits.as_ref().map(|bits| bits.unlike), &gpu.hash), (Some(0), &cpu.hash));
        assert!(cpu.hash.is_some() && case.options.ends_with("--path strict"), "{}", case.options);
    }
    let text = table::text(&report);
    assert!(text.contains("to the bit: 2 of 2 pictures are the CPU rasterizer's"), "{text}");
    check(&report, &plans.corpus()).expect("it is believed");
}

#[test]
fn one_wrong_bit_differs_though_it_is_within_every_bound() {
    let plans = strict();
    let report = run_plans(&plans, Box::new(OneBit));
    let subject = &report.subjects[1];
    assert_eq!((report.state(), report.state_of(&report.subjects[0])), (State::Differ, State::Agree));
    for (case, outcome) in report.outcomes(&subject.id) {
        assert!(outcome.pairs.iter().all(|pair| pair.agree), "{}: {:?}", case.key, outcome.pairs);
        assert_eq!(outcome.bits.as_ref().map(|bits| bits.unlike), Some(1));
        assert_ne!(outcome.hash, case.outcomes[0].hash);
    }
    let text = table::text(&report);
    assert!(text.contains("0 of 2 pictures") && text.contains("position 1"), "{text}");
    let xml = String::from_utf8(junit::xml(&report).expect("XML")).expect("UTF-8");
    assert!(
        xml.contains("1 pixels have other bits than the CPU rasterizer&apos;s")
            || xml.contains("1 pixels have other bits")
    );
    check(&report, &plans.corpus()).expect("it is believed");
}

#[test]
fn a_report_whose_bits_were_left_out_is_not_believed() {
    let plans = strict();
    let right = run_plans(&plans, Box::new(OneBit));
    let refused = |edit: &dyn Fn(&mut Report)| {
        let mut report = right.clone();
        edit(&mut report);
        format!("{:#}", check(&report, &plans.corpus()).expect_err("it is refused"))
    };
    let left_out = refused(&|report| report.cases[0].outcomes[1].bits = None);
    assert!(left_out.contains("its bits are told, or not, against its path"), "{left_out}");
    let too_many = refused(&|report| report.cases[0].outcomes[1].bits.as_mut().expect("bits").unlike = 1 << 20);
    assert!(too_many.contains("pixels have other bits, of"), "{too_many}");
    let plain = Plans { path: Path::Fragment, ..strict() };
    let other = format!("{:#}", check(&right, &plain.corpus()).expect_err("another corpus"));
    assert!(other.contains("another corpus"), "{other}");
}
