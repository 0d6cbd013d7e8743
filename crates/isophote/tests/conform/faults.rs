//! Adapters that are wrong, lost or not there, and runs that are interrupted.

use crate::setting::{AGREEING, DIFFERING, Losing, folder, gpu, plans, run};
use isophote::conform::report::{Report, State};
use isophote::conform::run::Adapter;
use isophote::conform::table;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};

#[test]
fn all_agree_on_a_sound_adapter() {
    let report = &*AGREEING;
    assert_eq!(report.state(), State::Agree, "{}", table::text(report));
    assert_eq!(report.cases.len(), 3);
    for case in &report.cases {
        let pairs: Vec<[&str; 2]> =
            case.outcomes.iter().flat_map(|o| &o.pairs).map(|p| [p.reference.as_str(), p.candidate.as_str()]).collect();
        assert_eq!(pairs, [["raycast", "raster"], ["raycast", "gpu"], ["raster", "gpu"]]);
        assert!(case.picture.is_some() && case.outcomes.iter().all(|outcome| outcome.picture.is_some()));
    }
}

#[test]
fn one_wrong_pixel_differs_and_is_shown_with_its_stages() {
    let report = &*DIFFERING;
    assert_eq!((report.state(), report.state_of(&report.subjects[0])), (State::Differ, State::Agree));
    for (case, outcome) in report.outcomes(&report.subjects[1].id) {
        for pair in &outcome.pairs {
            assert_eq!((pair.agree, pair.differing, pair.worst.len()), (false, 1, 1), "{}", case.key);
            let worst = &pair.worst[0];
            assert_eq!([worst.x, worst.y], case.size.map(|side| side / 2));
            assert!(worst.reference.is_some() && worst.candidate.is_some());
            assert!(pair.difference.is_some());
        }
    }
    let text = table::text(report);
    assert!(text.contains("DIFFER") && text.contains("pole/above/fragment/specialised"), "{text}");
}

#[test]
fn a_lost_adapter_keeps_what_it_measured_and_the_others_go_on() {
    let report = run(Box::new(Losing { gpu: gpu(), left: 1 }));
    let [cpu, lost] = &report.subjects[..] else { panic!("two subjects") };
    assert_eq!(
        (report.state(), report.state_of(cpu), report.state_of(lost)),
        (State::NotRun, State::Agree, State::NotRun)
    );
    assert_eq!(report.outcomes(&lost.id).count(), 1);
    let missing: Vec<String> = report.missing(&lost.id).iter().map(|key| key.scene.clone()).collect();
    assert_eq!(missing, ["repeated-knots", "knots-unclamped"]);
    let why = lost.failure.as_deref().expect("a reason");
    assert!(why.contains("repeated-knots/framed") && why.contains("pulled out"), "{why}");
    let text = table::text(&report);
    assert!(text.contains(&lost.name) && text.contains("NOT RUN") && text.contains("PARTIAL"), "{text}");
}

#[test]
fn a_run_that_is_killed_leaves_a_report_that_says_so() {
    let (plans, mut kept) = (plans(), vec![]);
    let mut adapters: [Box<dyn Adapter>; 1] = [Box::new(gpu())];
    let mut report = plans.report(vec![adapters[0].subject()]);
    let folder = folder("killed");
    let died = plans.run(&mut adapters, &mut report, &AtomicBool::new(false), &mut |report| {
        report.write(&folder)?;
        kept.push(report.cases.len());
        if kept.len() == 2 { Err(anyhow::anyhow!("killed")) } else { Ok(()) }
    });
    assert!(died.is_err() && kept == [1, 2]);
    let read = Report::read(&folder.join("report.json")).expect("whole");
    assert_eq!((read.cases.len(), read.state()), (2, State::NotRun));
}

#[test]
fn an_interrupt_ends_the_run_after_the_case_at_hand() {
    let plans = plans();
    let mut adapters: [Box<dyn Adapter>; 0] = [];
    let mut report = plans.report(vec![]);
    let stop = AtomicBool::new(true);
    plans.run(&mut adapters, &mut report, &stop, &mut |_| Ok(())).expect("nothing to write");
    assert!(stop.load(Ordering::Relaxed));
    assert_eq!((report.cases.len(), report.state()), (1, State::NotRun));
}

#[test]
fn without_an_adapter_the_cpu_is_judged_and_the_exit_code_is_2() {
    let folder = folder("no-adapter");
    let output = Command::new(env!("CARGO_BIN_EXE_isophote"))
        .args(["conform", "--shard", "2/18", "--format", "json", "--out"])
        .arg(&folder)
        .env("VK_DRIVER_FILES", "/nonexistent.json")
        .env("VK_ICD_FILENAMES", "/nonexistent.json")
        .output()
        .expect("isophote starts");
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Report = serde_json::from_slice(&output.stdout).expect("one JSON object and nothing else");
    // A case a technique.
    assert_eq!((report.cases.len(), report.cases[0].outcomes.len()), (techniques::ALL.len(), 1));
    let why = report.subjects[1].failure.as_deref().expect("a reason");
    assert!(why.contains("apt-get install mesa-vulkan-drivers"), "{why}");
    assert!(["report.html", "report.json", "junit.xml"].iter().all(|name| folder.join(name).exists()));
}

#[test]
fn an_adapter_of_another_name_and_a_bad_shard_are_named() {
    for (arguments, words) in
        [(["--shard", "4/3"], ["shard 4/3", "from 1"]), (["--suite", "huge"], ["huge", "standard"])]
    {
        let output =
            Command::new(env!("CARGO_BIN_EXE_isophote")).arg("conform").args(arguments).output().expect("starts");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}
