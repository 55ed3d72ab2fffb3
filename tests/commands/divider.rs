//! The resistors before the board's pin.

use super::{json, number, piezo, refused};

/// 3.3 V, the converter's reference.
const REFERENCE_V: f64 = 3.3;

#[test]
fn it_says_what_to_buy_and_the_line_to_paste() {
    let printed = piezo().args(["divider", "--monitor", "0:10", "--amplifier", "-30:130"]).assert().success();
    let printed = String::from_utf8(printed.get_output().stdout.clone()).unwrap();
    for part in [
        "R1 = ",
        "R2 = ",
        "R3 = ",
        "follower",
        "Resistors of 1 %",
        "adc_span = [",
        "--adc-span -",
        "1.12 µs",
        "wire off",
    ] {
        assert!(printed.contains(part), "{part:?} is missing in\n{printed}");
    }
    assert!(!printed.contains("amplify"), "{printed}");
    let small = piezo().args(["divider", "--monitor", "0:0.1"]).assert().success();
    let small = String::from_utf8(small.get_output().stdout.clone()).unwrap();
    assert!(small.contains("Only 3 % of the converter's range is used"), "{small}");
    // What nobody has said is not made up.
    let printed = piezo().args(["divider", "--monitor", "-10:10"]).assert().success();
    let printed = String::from_utf8(printed.get_output().stdout.clone()).unwrap();
    assert!(!printed.contains("adc_span = [") && printed.contains("with --amplifier V:V this prints"), "{printed}");
}

#[test]
fn what_it_prints_follows_from_its_resistors() {
    let of = |arguments: &[&str]| json(piezo().args([&["divider", "--json"], arguments].concat()));
    for (arguments, low, high, field) in [
        (&["--monitor", "-10:10", "--amplifier", "-100:100"][..], -10.0, 10.0, "adc_span"),
        (&["--sensor", "0:10", "--displacement", "0:30", "--series", "e24"], 0.0, 10.0, "sensor_span"),
    ] {
        let found = of(arguments);
        let conductance = |name: &str| {
            let ohms = found.pointer(&format!("/resistors_ohm/{name}")).unwrap().as_f64();
            ohms.map_or(0.0, f64::recip)
        };
        let (g1, g2, g3) = (conductance("r1"), conductance("r2"), conductance("r3"));
        let pin = |volts: f64| (g1 * volts + g2 * REFERENCE_V) / (g1 + g2 + g3);
        assert!((pin(low) - number(&found, "/pin_v/0")).abs() < 1e-9 && pin(low) >= 0.15, "{found}");
        assert!((pin(high) - number(&found, "/pin_v/1")).abs() < 1e-9 && pin(high) <= 3.15, "{found}");
        let (zero, full) = (number(&found, "/codes_v/0"), number(&found, "/codes_v/1"));
        assert!(pin(zero).abs() < 1e-9 && (pin(full) - REFERENCE_V).abs() < 1e-9);
        // Nothing flows through R1 any more.
        let open = REFERENCE_V * g2 / (g2 + g3);
        assert!((pin(number(&found, "/open_v")) - open).abs() < 1e-9, "{found}");
        // The line of board.toml: the same ends in the unit of what is measured.
        let scale = if field == "adc_span" { 10.0 } else { 3.0 };
        assert!((number(&found, &format!("/{field}/0")) - scale * zero).abs() < 1e-9, "{found}");
        assert!(number(&found, "/tolerances/0/off_v") > 9.0 * number(&found, "/tolerances/1/off_v"), "{found}");
    }
}

#[test]
fn an_output_stage_follows_from_its_resistors_and_says_what_it_gives_without_power() {
    let arguments = ["divider", "--input", "-10:10", "--amplifier", "-30:130"];
    let found = json(piezo().args([&arguments[..], &["--json"]].concat()));
    let ohms = |name: &str| number(&found, &format!("/resistors_ohm/{name}"));
    let (rf, rg, ro) = (ohms("rf"), ohms("rg"), ohms("ro"));
    let input = |pin: f64| pin * (1.0 + rf / rg + rf / ro) - REFERENCE_V * rf / ro;
    for (end, volts) in [(0, -10.0), (1, 10.0)] {
        let pin = number(&found, &format!("/pin_v/{end}"));
        assert!((input(pin) - volts).abs() < 1e-9 && (0.231..=3.069).contains(&pin), "{found}");
        let drive = number(&found, &format!("/drive_span/{end}"));
        let at_end = input(REFERENCE_V * f64::from(end));
        assert!((drive - (50.0 + 8.0 * at_end)).abs() < 1e-9, "{found}");
    }
    // Two resistors hold the floating pin where the amplifier's output is at 0 V: with no current through the low-pass.
    let (up, down) = (number(&found, "/up_and_down_kohm/0"), number(&found, "/up_and_down_kohm/1"));
    // To what resistors of 5 % leave of that.
    assert!((50.0 + 8.0 * input(REFERENCE_V * down / (up + down))).abs() < 1.5 && up.min(down) == 100.0, "{found}");
    let printed = piezo().args(arguments).assert().success();
    let printed = String::from_utf8(printed.get_output().stdout.clone()).unwrap();
    let monitor = piezo().args(["divider", "--monitor", "0:10", "--amplifier", "0:100"]).assert().success();
    let monitor = String::from_utf8(monitor.get_output().stdout.clone()).unwrap();
    assert!(monitor.contains("# amplifier_slew = <V/s>") && monitor.contains("peak current"), "{monitor}");
    for part in [
        "RF = ",
        "RG = ",
        "RO = ",
        "without power",
        "  the board without power (A2 and its 3.3 V at 0 V): 0.000 V, 50.00 V of the amplifier",
        "drive_span = [",
        "--drive-span -",
    ] {
        assert!(printed.contains(part), "{part:?} is missing in\n{printed}");
    }
    let unsaid = piezo().args(["divider", "--input", "0:10"]).assert().success();
    let unsaid = String::from_utf8(unsaid.get_output().stdout.clone()).unwrap();
    assert!(!unsaid.contains("drive_span = [") && unsaid.contains("with --amplifier V:V this prints"), "{unsaid}");
}

#[test]
fn what_it_cannot_do_is_said() {
    refused(&["divider", "--input", "0:1000"], &["0 … 1000 V", "no amplifier's input"]);
    refused(&["divider", "--input", "0:10", "--monitor", "0:10"], &["--input", "--monitor"]);
    refused(&["divider", "--monitor", "10:0"], &["10:0", "lowest voltage first"]);
    refused(&["divider"], &["--monitor"]);
    refused(&["divider", "--displacement", "0:3"], &["--monitor"]);
    refused(&["divider", "--monitor", "0:10", "--displacement", "0:3"], &["--displacement", "--monitor"]);
}
