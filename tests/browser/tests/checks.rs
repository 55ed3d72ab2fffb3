//! The checks themselves: a sound page passes, and each check finds the fault it is for.

use std::fs;

use anyhow::{Result, ensure};
use report_browser_test::{Viewport, inspect, launch};

const PHONE: Viewport = Viewport { width: 360, height: 740, scale: 2.0, mobile: true, least_text: 9.0 };

const SOUND: &str = r#"<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>Sound</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>svg { width: 100%; height: auto }</style></head><body><p>Four plots.</p>"#;

const PLOT: &str = r#"<figure><svg viewBox="0 0 320 200"><text x="8" y="20" font-size="12">µm over V</text>
<polyline points="10,190 150,40 310,20" fill="none" stroke="black"/></svg></figure>"#;

#[test]
fn each_check_finds_its_fault_and_none_in_a_sound_page() -> Result<()> {
    let sound = format!("{SOUND}{PLOT}{PLOT}{PLOT}{PLOT}</body></html>");
    let spoilt = |part: &str, by: &str| {
        assert!(sound.contains(part), "the sound page has no {part}");
        sound.replacen(part, by, 1)
    };
    let after = |by: &str| spoilt("</body>", &format!("{by}</body>"));
    let pages = [
        (spoilt("Sound", ""), "no title"),
        (spoilt("width=device-width, initial-scale=1", ""), "laid out"),
        (after("<pre style='width: 500px'>wide</pre>"), "scrolls sideways"),
        (spoilt(PLOT, ""), "3 plots instead of 4"),
        (spoilt("<figure>", "<figure style='width: 0; margin: 0'>"), "plot 1 has no size"),
        (spoilt("<svg ", "<svg style='position: fixed; left: 90px' "), "beyond the screen"),
        (spoilt("points=\"10,190 150,40 310,20\"", ""), "plot 1 has no curve"),
        (spoilt("stroke=\"black\"", ""), "plot 1 has no curve"),
        (spoilt("10,190", "NaN,190"), "<polyline> attribute points"),
        (spoilt("0 0 320 200", "0 0 640 400"), "text \"µm over V\" is"),
        (spoilt("<p>", "<p style='font-size: 8px'>"), "text \"Four plots.\" is 8.0 px high"),
        (spoilt("x=\"8\"", "x=\"290\""), "cut off"),
        (after("<script>throw new Error('thrown')</script>"), "JavaScript exception: Error: thrown"),
        (after("<script>console.error('said')</script>"), "console error: \"said\""),
        (after("<img src='http://example.com/a.png' alt=''>"), "leaves the file: http://example.com/a.png"),
        (after("<img src='other.png' alt=''>"), "leaves the file: file:"),
    ];
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("page.html");
    let url = format!("file://{}", file.display());
    let mut browser = launch()?;
    let mut found = |page: &str| -> Result<Vec<String>> {
        fs::write(&file, page)?;
        Ok(inspect(&mut browser, &url, PHONE, 4)?.1)
    };

    let none = found(&sound)?;
    ensure!(none.is_empty(), "faults in the sound page: {none:#?}");
    for (page, fault) in &pages {
        let faults = found(page)?;
        ensure!(faults.iter().any(|found| found.contains(fault)), "{fault:?} is not among {faults:#?} of\n{page}");
    }
    Ok(())
}
