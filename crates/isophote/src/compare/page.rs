//! One comparison as one HTML file that opens from disk: the answer, pictures, maps of what was judged, tables and settings.

use super::maps::{self, AGREES, BEYOND, NO_VERDICT, SHARE_ENDS};
use super::next::Next;
use super::pictures::Pictures;
use super::verdict::short;
use crate::leaf;
use anyhow::Result;
use compare::{PairReport, Verdict};
use scene::Viewport;
use std::fmt::Write;
use suite::embedded::data_uri;
use suite::text::html;

/// What a page shows besides its pictures.
pub(super) struct Page<'a> {
    /// The model's name.
    pub model: &'a str,
    /// The answer in one plain line.
    pub line: String,
    /// 0, 1 or 2, as the command exits.
    pub code: u8,
    /// Settings by name.
    pub facts: Vec<(&'static str, String)>,
    pub pairs: &'a [PairReport],
    pub viewport: Viewport,
    /// What says more of a pixel.
    pub next: &'a Next,
}

impl Page<'_> {
    /// The page.
    ///
    /// # Errors
    /// Where a picture cannot be encoded.
    pub fn text(&self, pictures: &Pictures) -> Result<String> {
        let title = format!("Comparison of {}", html(self.model));
        let (state, word) = match self.code {
            0 => ("agree", "Agree."),
            1 => ("differ", "Differ."),
            _ => ("partial", "Not all was compared."),
        };
        let mut page = leaf::begun(&title, (state, word, &self.line));
        page.push_str("<section><h2>Pictures</h2><div class=\"maps large\">\n");
        for (name, picture) in pictures.named()? {
            leaf::figure(&mut page, &html(name), &data_uri(&picture)?)?;
        }
        page.push_str("</div></section>\n");
        for pair in self.pairs {
            self.pair(&mut page, pair)?;
        }
        leaf::ended(page, &self.facts)
    }

    fn pair(&self, page: &mut String, pair: &PairReport) -> Result<()> {
        let name = html(&format!("{} | {}", pair.reference, pair.candidate));
        let (state, word) = match pair.verdict {
            Verdict::Agree => ("agree", "agrees"),
            Verdict::Differ => ("differ", "differs"),
            Verdict::NoVerdict => ("partial", "no verdict"),
        };
        writeln!(page, "<section><h2>{name} <span class=\"badge {state}\">{word}</span></h2>")?;
        writeln!(page, "<p class=\"lead\">{}</p>\n<div class=\"maps large\">", html(&pair.bounds))?;
        leaf::figure(page, "Share used of what is allowed", &data_uri(&maps::shares(pair, self.viewport)?)?)?;
        leaf::figure(page, "Causes", &data_uri(&maps::causes(pair, self.viewport)?)?)?;
        page.push_str("</div>\n<ul class=\"legend\">");
        let [low, high] = SHARE_ENDS.map(colour);
        write!(
            page,
            "<li>0 % <i class=\"ramp\" style=\"background:linear-gradient(to right,{low},{high})\"></i> 100 %</li>"
        )?;
        let mut entry =
            |rgb: [u8; 3], text: String| write!(page, "<li><i style=\"background:{}\"></i> {text}</li>", colour(rgb));
        entry(BEYOND, format!("beyond: {} pixels", pair.differing()))?;
        entry(NO_VERDICT, format!("without a verdict: {}", pair.unbounded))?;
        entry(AGREES, format!("agree: {}", pair.agree))?;
        for (cause, count, rgb) in maps::legend(pair) {
            entry(rgb, format!("{}: {count}", html(cause.label())))?;
        }
        page.push_str("</ul>\n<table><tbody>\n");
        let share = |x: f64| if x > 0.0 { format!("{:.1} %", 100.0 * x) } else { "—".to_owned() };
        let of_agreeing = |text: String| if pair.agree > 0 { text } else { "—".to_owned() };
        let c = pair.coverage;
        let mut rows = vec![
            ("pixels that both show, one alone, neither", format!("{}, {}, {}", c.full, c.partial, c.none)),
            (
                "the farthest off its ray, and allowed there",
                of_agreeing(format!("{} px, {} px", short(pair.max_px), short(pair.bound_px))),
            ),
            (
                "share used: position, normal, curvatures",
                [pair.position_share, pair.normal_share, pair.curvature_share].map(share).join(", "),
            ),
        ];
        rows.extend(
            pair.reasons().into_iter().map(|(reason, count)| (reason.label(), format!("{count} without a verdict"))),
        );
        for (what, value) in rows {
            writeln!(page, "<tr><th scope=\"row\">{what}</th><td>{value}</td></tr>")?;
        }
        page.push_str("</tbody></table>\n");
        worst(page, pair, self.next)?;
        page.push_str("</section>\n");
        Ok(())
    }
}

fn worst(page: &mut String, pair: &PairReport, next: &Next) -> Result<()> {
    if pair.worst.is_empty() {
        return Ok(());
    }
    page.push_str("<h3>The worst pixels</h3><div class=\"scroll\"><table><thead><tr><th>pixel</th><th>cause</th>");
    page.push_str("<th>times over</th><th>what</th></tr></thead><tbody>\n");
    for pixel in &pair.worst {
        let sample = pixel.sample.map_or(String::new(), |sample| format!(" sample {sample}"));
        let times = if pixel.excess.is_finite() { format!("{:.3}", pixel.excess) } else { "∞".to_owned() };
        let (x, y, cause, detail) = (pixel.x, pixel.y, pixel.cause.label(), html(&pixel.detail));
        writeln!(
            page,
            "<tr><td>{x}, {y}{sample}</td><td>{cause}</td><td class=\"number\">{times}</td><td>{detail}</td></tr>"
        )?;
    }
    page.push_str("</tbody></table></div>\n");
    if let Some(pixel) = pair.worst.first() {
        writeln!(page, "<h3>Next</h3><code>{}</code>", html(&next.command(pixel)))?;
    }
    Ok(())
}

fn colour([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}
