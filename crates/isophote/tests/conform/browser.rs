//! The page in a real browser: it loads without a complaint, and what it offers works.

use crate::devtools::{Page, is_there};
use crate::setting::{AGREEING, DIFFERING, folder};
use isophote::conform::html;
use isophote::conform::report::Report;
use serde_json::json;

/// A report of a sound adapter and of one that is wrong, with counted histograms on the latter.
fn report() -> Report {
    let mut report = DIFFERING.clone();
    for pair in report.cases.iter_mut().flat_map(|case| &mut case.outcomes).flat_map(|outcome| &mut outcome.pairs) {
        for budget in [&mut pair.position, &mut pair.normal, &mut pair.curvature] {
            budget.histogram = (0..20).map(|bin| 4000usize >> (2 * bin).min(63)).collect();
        }
    }
    report
}

fn open(name: &str, report: &Report) -> (Page, std::path::PathBuf) {
    let folder = folder(name);
    let file = folder.join("report.html");
    std::fs::write(&file, html::page(report).expect("a page")).expect("a file can be written");
    (Page::open(&file, folder.join("profile"), [1280, 900]), folder)
}

#[test]
fn the_page_loads_sorts_filters_and_swipes() {
    if !is_there("the_page_loads_sorts_filters_and_swipes", "1 of 3") {
        return;
    }
    let (mut page, folder) = open("page", &report());
    assert_eq!(page.evaluate("document.querySelector('#verdict').className"), "verdict differ");
    assert_eq!(page.evaluate("document.querySelectorAll('#subjects article').length"), 2);
    let rows = "document.querySelectorAll('#list tr.case').length";
    assert_eq!(page.evaluate(rows), 6);
    // What differs stands first.
    assert_eq!(page.evaluate("document.querySelector('#list .badge').textContent"), "differs");

    let scenes = "[...document.querySelectorAll('#list tr.case td:first-child')].map(td => td.textContent)";
    let header = "document.querySelector('#list th button')";
    page.evaluate(&format!("{header}.click()"));
    let ascending = page.evaluate(scenes);
    assert_eq!(ascending[0], "knots-unclamped");
    assert_eq!(page.evaluate(&format!("{header}.parentElement.getAttribute('aria-sort')")), "ascending");
    page.evaluate(&format!("{header}.click()"));
    assert_eq!(page.evaluate(scenes)[0], "repeated-knots");
    let numbers = "[...document.querySelectorAll('#list tr.case td:nth-child(6)')].map(td => Number(td.textContent.replace(',', '')))";
    page.evaluate("document.querySelectorAll('#list th button')[5].click()");
    let pixels: Vec<u64> = serde_json::from_value(page.evaluate(numbers)).expect("numbers");
    assert!(pixels.is_sorted_by(|a, b| a >= b) && pixels[0] > pixels[5], "{pixels:?}");

    let set = |id: &str, value: &str| {
        format!(
            "{{ const e = document.getElementById('{id}'); e.value = '{value}'; e.dispatchEvent(new Event('input')); }}"
        )
    };
    page.evaluate(&set("state", "failing"));
    assert_eq!(page.evaluate(rows), 3);
    page.evaluate(&set("find", "POLE"));
    assert_eq!(page.evaluate(rows), 1);
    assert_eq!(page.evaluate("document.getElementById('count').textContent"), "1 of 6 cases");
    page.evaluate(&set("find", "nothing like it"));
    assert_eq!(page.evaluate(rows), 0);
    page.evaluate("document.querySelector('#matrix td:nth-child(3) button').click()");
    assert_eq!(page.evaluate(rows), 1);

    // By keyboard: open the case, then move the slider.
    page.evaluate("document.querySelector('#list .open').focus()");
    page.press("Enter", 13, "\r");
    assert_eq!(page.evaluate("document.querySelector('#list .open').getAttribute('aria-expanded')"), "true");
    let panel =
        "document.querySelector('.panel').scrollWidth <= document.querySelector('#list').parentElement.clientWidth";
    assert_eq!(page.evaluate(panel), true);
    let clip = "document.querySelector('.swipe img:nth-of-type(2)').style.clipPath";
    assert_eq!(page.evaluate(clip), "inset(0px 50% 0px 0px)");
    page.evaluate("document.querySelector('.slide').focus()");
    for _ in 0..10 {
        page.press("ArrowLeft", 37, "");
    }
    assert_eq!(page.evaluate("document.querySelector('.slide').value"), "40");
    assert_eq!(page.evaluate(clip), "inset(0px 60% 0px 0px)");
    let broken = "[...document.images].filter(i => !i.complete || i.naturalWidth === 0).length";
    assert_eq!((page.evaluate(broken), page.evaluate("document.images.length >= 4")), (json!(0), json!(true)));
    let values = page.evaluate("document.querySelector('.stages').textContent");
    assert!(values.as_str().is_some_and(|text| text.contains("k1, k2")), "{values}");
    let again = page.evaluate("document.querySelector('.panel code').textContent");
    assert!(again.as_str().is_some_and(|text| text.starts_with("isophote pixel ")), "{again}");
    assert_eq!(page.evaluate("document.querySelectorAll('.panel .histogram rect').length"), 60);
    page.screenshot(&folder.join("case.png"));

    assert_eq!(page.complaints, [""; 0]);
}

#[test]
fn nothing_is_cut_off_on_a_narrow_window_in_either_colour() {
    if !is_there("nothing_is_cut_off_on_a_narrow_window_in_either_colour", "2 of 3") {
        return;
    }
    let (mut page, folder) = open("narrow", &AGREEING);
    for theme in ["light", "dark"] {
        for width in [1280, 390] {
            page.resize([width, 1400]);
            page.evaluate(&format!("document.documentElement.dataset.theme = '{theme}'"));
            let overflow = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth");
            assert_eq!(overflow, 0, "{theme}, {width} pixels wide");
            page.screenshot(&folder.join(format!("{theme}-{width}.png")));
        }
    }
    assert_eq!(page.evaluate("document.querySelector('#verdict').className"), "verdict agree");
    let unnamed = "[...document.querySelectorAll('button, input, select')].filter(e => !(e.textContent.trim() || e.getAttribute('aria-label') || (e.labels && e.labels.length))).length";
    assert_eq!(page.evaluate(unnamed), 0);
    assert_eq!(page.complaints, [""; 0]);
}

#[test]
fn a_broken_page_is_noticed() {
    if !is_there("a_broken_page_is_noticed", "3 of 3") {
        return;
    }
    let folder = folder("broken");
    let file = folder.join("report.html");
    let page = html::page(&AGREEING).expect("a page").replace("function detail(", "undefinedName(); function detail(");
    std::fs::write(&file, page).expect("a file can be written");
    let mut page = Page::open(&file, folder.join("profile"), [800, 600]);
    page.evaluate("1");
    assert_eq!(page.complaints.len(), 1, "{:?}", page.complaints);
}
